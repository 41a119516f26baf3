from api.cli.hold_lines import hold_line

AT = "2026-05-04T12:00:00.000Z"


def test_a_hold_says_whose_it_is_why_and_since_when() -> None:
    hold = {"owner": "operator", "reason": "lunch", "since_at": AT}
    assert hold_line(hold) == f"held by operator: lunch  [since {AT}]"


def test_a_hold_without_a_reason_says_no_more() -> None:
    assert hold_line({"owner": "a", "reason": "", "since_at": AT}) == f"held by a  [since {AT}]"
