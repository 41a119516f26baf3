"""Work on posted models, as the worker does it."""

import json

import pytest

from api.http.body_parsing import InvalidBodyError, MalformedBodyError
from api.http.model_jobs import check_posted, infer, infer_posted
from api.http.schemas.inference import InferenceBody
from domain.errors import InvalidModelError
from service.files.model_file import read_model
from tests.support.http_robot import ACTUATION

MODEL = read_model(ACTUATION).model


def test_all_parts_of_the_model_are_in_the_answer() -> None:
    answer = infer(MODEL, InferenceBody())

    assert set(answer.parts) == {"actuation", "drive_base", "manipulator"}
    assert {part.state for part in answer.parts.values()} == {"unknown"}


def test_a_mode_belongs_only_to_active() -> None:
    body = InferenceBody.model_validate({"targets": {"actuation": "inactive.PERFORMANCE"}})
    nodes = {"drive_base": "inactive", "manipulator": "inactive"}
    body = InferenceBody.model_validate({"targets": body.targets, "nodes": nodes})

    answer = infer(MODEL, body)

    assert (answer.parts["actuation"].state, answer.parts["actuation"].mode) == ("inactive", None)


@pytest.mark.parametrize(
    ("target", "mode"),
    [
        ("active.FAST", "FAST"),
        ("activating.FAST", "FAST"),
        ({"state": "active", "mode": "A.B"}, "A.B"),
        ({"state": "active", "mode": ""}, None),
        ({"state": "inactive", "mode": "FAST"}, None),
    ],
)
def test_a_target_has_a_mode_only_where_a_label_would(target: object, mode: str | None) -> None:
    nodes = {"drive_base": "errorprocessing"}
    body = InferenceBody.model_validate({"targets": {"drive_base": target}, "nodes": nodes})

    (deviation,) = infer(MODEL, body).deviations

    assert deviation.target.mode == mode


def test_a_label_is_no_state() -> None:
    target = {"state": "active.FAST", "mode": None}
    body = InferenceBody.model_validate({"targets": {"drive_base": target}})

    with pytest.raises(InvalidBodyError, match=r"no lifecycle state 'active\.FAST'"):
        infer(MODEL, body)


def test_an_integer_is_no_double() -> None:
    node = {"state": "active", "parameters": {"max_torque": 1}}
    model = read_model(ACTUATION.replace("max_torque: 0.1}", "max_torque: 1.0}")).model

    answer = infer(model, InferenceBody.model_validate({"nodes": {"manipulator": node}}))

    assert answer.parts["manipulator"].mode is None


def test_every_wrong_name_is_told_at_once() -> None:
    body = InferenceBody.model_validate({"targets": {"x": "active"}, "nodes": {"y": "on"}})

    with pytest.raises(InvalidBodyError) as raised:
        infer(MODEL, body)

    assert [(f.pointer, f.code) for f in raised.value.faults] == [
        ("/targets/x", "UNKNOWN_PART"),
        ("/nodes/y", "UNKNOWN_PART"),
    ]


def test_a_name_may_be_written_as_in_ros() -> None:
    body = {"targets": {"/drive_base": "inactive"}, "nodes": {"/drive_base": "active"}}

    answer = infer(MODEL, InferenceBody.model_validate(body))

    assert answer.parts["drive_base"].state == "active"
    assert [deviation.part for deviation in answer.deviations] == ["drive_base"]


def test_without_a_model_the_loaded_one_is_meant() -> None:
    other = ACTUATION.replace("drive_base", "wheels")

    loaded = json.loads(infer_posted(b"{}", ACTUATION))
    posted = json.loads(infer_posted(json.dumps({"model": other}).encode(), ACTUATION))

    assert "drive_base" in loaded["parts"]
    assert "wheels" in posted["parts"]


def test_a_bad_body_and_a_bad_model_are_told_apart() -> None:
    with pytest.raises(MalformedBodyError):
        infer_posted(b"{", ACTUATION)
    with pytest.raises(InvalidModelError):
        infer_posted(b'{"model": "a: ["}', ACTUATION)


def test_a_check_tells_whether_the_model_can_be_used() -> None:
    assert json.loads(check_posted(ACTUATION.encode())) == {"valid": True, "findings": []}
    assert json.loads(check_posted(b"a: ["))["valid"] is False
