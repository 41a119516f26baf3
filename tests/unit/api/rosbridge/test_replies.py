import json

from api.rosbridge.replies import PublishedTexts, response_text, sentence, status_text
from domain.errors import InvalidValueError, OutdatedReadingError


def test_a_status_says_what_went_wrong_with_which_operation() -> None:
    assert json.loads(status_text("error", "no", "publish:1")) == {
        "op": "status",
        "level": "error",
        "msg": "no",
        "id": "publish:1",
    }


def test_a_status_of_an_operation_without_an_id_has_none() -> None:
    assert "id" not in json.loads(status_text("error", "no", None))


def test_a_response_names_the_service_as_it_was_asked_for() -> None:
    assert json.loads(response_text("rosapi/topics", {"topics": []}, True, 0)) == {
        "op": "service_response",
        "service": "rosapi/topics",
        "values": {"topics": []},
        "result": True,
        "id": 0,
    }


def test_an_error_is_told_with_its_hint() -> None:
    assert sentence(OutdatedReadingError("estop", 2)).endswith("clock)")
    assert sentence(InvalidValueError("no")) == "no"


def test_a_message_is_sent_by_the_name_that_the_client_uses() -> None:
    text = PublishedTexts().text("/system_state", "system_state", {"state": 1})

    assert json.loads(text) == {"op": "publish", "topic": "system_state", "msg": {"state": 1}}


def test_a_message_for_several_clients_is_encoded_once() -> None:
    texts = PublishedTexts()
    message = {"state": 1}
    first = texts.text("/system_state", "/system_state", message)
    # What is known is not looked at again: messages are never changed.
    message["state"] = 2

    assert texts.text("/system_state", "/system_state", message) == first


def test_the_next_message_is_another_one() -> None:
    texts = PublishedTexts()
    texts.text("/system_state", "/system_state", {"state": 1})

    assert '"state":2' in texts.text("/system_state", "/system_state", {"state": 2})


def test_what_is_not_finite_is_null_since_json_has_nothing_else() -> None:
    text = PublishedTexts().text("/x", "/x", {"value": float("nan")})

    assert json.loads(text)["msg"] == {"value": None}
