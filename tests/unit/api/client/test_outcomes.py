from api.client.outcomes import refusal_lines


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
