from api.client.outcomes import no_connection, refusal_lines


def test_a_refusal_is_told_with_what_stands_against_it_and_what_helps() -> None:
    blocker = {"code": "ESTOP", "message": "e-stop is pressed", "path": ["actuation", "estop"]}
    refused = {"detail": "actuation cannot be changed", "blockers": [blocker], "hint": "release it"}

    assert list(refusal_lines(refused)) == [
        "rejected: actuation cannot be changed",
        "  ESTOP: e-stop is pressed (actuation > estop)",
        "  hint: release it",
    ]


def test_a_single_fault_of_a_body_is_told_once() -> None:
    fault = {"pointer": "/mode", "message": "there is no mode 'WARP'"}
    refused = {"detail": "/mode: there is no mode 'WARP'", "errors": [fault]}

    assert list(refusal_lines(refused)) == ["rejected: /mode: there is no mode 'WARP'"]


def test_faults_of_a_body_are_told_with_their_place() -> None:
    faults = [{"pointer": "/mode", "message": "too long"}, {"pointer": "", "message": "no object"}]

    assert list(refusal_lines({"title": "Invalid", "errors": faults})) == [
        "rejected: Invalid",
        "  /mode: too long",
        "  body: no object",
    ]


def test_https_on_a_service_that_speaks_http_is_told_without_the_words_of_tls() -> None:
    error = no_connection("https://robot:8000", OSError("[SSL: WRONG_VERSION_NUMBER] wrong"))

    assert str(error) == (
        "what answers at https://robot:8000 does not speak HTTPS; try http://robot:8000"
    )


def test_a_certificate_that_is_not_trusted_is_told_as_such() -> None:
    error = no_connection("https://robot", OSError("[SSL: CERTIFICATE_VERIFY_FAILED] self-signed"))

    assert "is not trusted" in str(error)


def test_a_service_that_does_not_listen_is_told_as_such() -> None:
    error = no_connection("https://robot", OSError("Connection refused"))

    assert str(error) == "no service answers at https://robot: is it running?"
