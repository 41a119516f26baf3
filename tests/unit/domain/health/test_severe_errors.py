"""Why the robot is in ERROR because of its parts."""

from dataclasses import replace

from domain.health.severe_errors import MAX_REASONS, SevereErrors, reason_of
from domain.snapshot import ErrorKey, ErrorState, ErrorView, Severity
from domain.state_and_mode import PartName

ARM = PartName("arm")
LOST, JAMMED = ErrorKey(ARM, "LOST"), ErrorKey(ARM, "JAMMED")


def view(
    key: ErrorKey,
    severity: Severity = Severity.CRITICAL,
    state: ErrorState = ErrorState.ACTIVE,
    roots: tuple[ErrorKey, ...] = (),
) -> ErrorView:
    return ErrorView(
        key, severity, state, False, f"{key.error} it is", 3, 2, 7, 1, caused_by=roots, roots=roots
    )


def test_only_critical_and_fatal_errors_that_are_on_count() -> None:
    severe = SevereErrors()
    for severity in Severity:
        severe.put(view(ErrorKey(ARM, severity.name), severity))
    severe.put(view(ErrorKey(ARM, "PENDING"), state=ErrorState.PENDING))
    assert severe.names == ("arm.CRITICAL", "arm.FATAL")


def test_one_that_ended_counts_no_more() -> None:
    severe = SevereErrors()
    severe.put(view(LOST))
    severe.put(view(LOST, state=ErrorState.NORMAL))
    assert (severe.names, severe.reasons(view)) == ((), ())


def test_the_reasons_are_the_same_object_until_one_changes() -> None:
    severe = SevereErrors()
    severe.put(view(LOST))
    first = severe.reasons(view)
    severe.put(view(JAMMED, Severity.WARNING))
    assert severe.reasons(view) is first
    severe.put(replace(view(LOST), message="it is gone"))
    assert severe.reasons(view)[0].message == "it is gone"


def test_roots_come_before_what_they_explain() -> None:
    severe = SevereErrors()
    severe.put(view(LOST, roots=(JAMMED,)))
    severe.put(view(JAMMED))
    codes = [(reason.code, reason.root_cause) for reason in severe.reasons(view)]
    assert codes == [("JAMMED", True), ("LOST", False)]
    assert severe.names == ("arm.LOST", "arm.JAMMED")


def test_a_reason_has_its_part_its_facts_and_its_roots_as_causes() -> None:
    reason = reason_of(view(LOST, roots=(JAMMED,)), view)
    assert (reason.code, reason.path, reason.value, reason.threshold, reason.since) == (
        "LOST",
        ("arm",),
        3,
        2,
        7,
    )
    assert [cause.code for cause in reason.causes] == ["JAMMED"]


def test_a_root_that_is_gone_is_no_cause_any_more() -> None:
    def gone(key: ErrorKey) -> ErrorView:
        return view(key, state=ErrorState.NORMAL)

    assert reason_of(view(LOST, roots=(JAMMED,)), gone).causes == ()


def test_of_thousands_no_more_reasons_are_shown_than_can_be_read() -> None:
    severe = SevereErrors()
    for number in range(MAX_REASONS + 5):
        severe.put(view(ErrorKey(PartName(f"n{number}"), "LOST")))
    assert len(severe.reasons(view)) == MAX_REASONS
    assert len(severe.names) == MAX_REASONS + 5
