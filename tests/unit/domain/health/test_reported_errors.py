"""Errors that others find."""

import pytest

from domain.errors import (
    NotReportedError,
    PilothouseError,
    UnknownErrorNameError,
    UnknownPartError,
)
from domain.inputs import ErrorReport, Restored
from domain.kept import Kept, KeptReport
from domain.outbox import Outputs
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import NodeModel, SmhModel
from domain.snapshot import ErrorKey, ErrorView, Severity
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds

ARM = PartName("arm")
JAMMED = ErrorKey(ARM, "JAMMED")
MODEL = SmhModel(
    {ARM: NodeModel(ARM)},
    {},
    errors={
        ARM: {
            "JAMMED": DeclaredError(severity=Severity.URGENT, message="the gripper is stuck"),
            "BLIND": DeclaredError(caused_by=(JAMMED,)),
        }
    },
)


@pytest.fixture
def core() -> Supervision:
    return Supervision(MODEL, SupervisionSettings(), 0)


def report(core: Supervision, at_s: float = 1, **more: object) -> Outputs:
    given = {"part": ARM, "error": "JAMMED", "active": True} | more
    return core.handle(ErrorReport(**given), seconds(at_s))  # type: ignore[arg-type]


def jammed(core: Supervision) -> ErrorView:
    return core.error(JAMMED)


def kinds(outputs: Outputs) -> list[str]:
    return [event.kind for event in outputs.events]


def test_a_report_raises_an_error_and_another_one_ends_it(core: Supervision) -> None:
    raised = report(core, message="current 9 A", value=9.0)
    view = jammed(core)
    assert (view.state.is_on, view.message, view.value) == (True, "current 9 A", 9.0)
    assert kinds(raised) == ["error.reported", "error.raised", "error.raised"]
    assert kinds(report(core, 2, active=False)) == [
        "error.reported",
        "error.cleared",
        "error.cleared",
    ]
    assert not jammed(core).state.is_on


def test_the_same_report_again_leaves_no_trace(core: Supervision) -> None:
    report(core)
    again = report(core, 2)
    assert (kinds(again), again.kept, again.errors) == ([], (), frozenset())
    assert kinds(report(core, 3, active=False))[0] == "error.reported"
    assert kinds(report(core, 4, active=False)) == []


def test_what_is_found_later_is_shown_and_the_error_stays_since_when_it_is(
    core: Supervision,
) -> None:
    report(core)
    report(core, 2, message="current 12 A")
    assert (jammed(core).message, jammed(core).since) == ("current 12 A", seconds(1))


def test_a_reported_error_is_there_after_a_restart_until_it_is_over(core: Supervision) -> None:
    kept = [keeping.value for keeping in report(core).kept if keeping.kind is KeptReport]
    after = Supervision(MODEL, SupervisionSettings(), seconds(50))
    back = after.handle(Restored(tuple(filter(None, kept)), boot=2), seconds(51))
    assert jammed(after).state.is_on
    assert jammed(after).since == seconds(1)
    assert "error.raised" in kinds(back)
    gone = report(after, 60, active=False).kept
    assert [(k.kind, k.value) for k in gone if k.kind is KeptReport] == [(KeptReport, None)]


def test_a_report_of_an_error_that_is_declared_no_more_is_left_out() -> None:
    old: tuple[Kept, ...] = (KeptReport(ARM, "BENT", "it is bent", None, 1),)
    core = Supervision(MODEL, SupervisionSettings(), 0)
    told = core.handle(Restored(old, boot=2), 0)
    (left_out,) = [event for event in told.events if event.kind == "service.not_restored"]
    assert "arm.BENT" in str(left_out.data)


@pytest.mark.parametrize(
    ("part", "error", "why"),
    [
        (ARM, "BLIND", NotReportedError),
        (ARM, "UNREACHABLE", NotReportedError),
        (None, "BATTERY_LOW", NotReportedError),
        (ARM, "BENT", UnknownErrorNameError),
        (None, "JAMMED", UnknownErrorNameError),
        (PartName("leg"), "JAMMED", UnknownPartError),
    ],
)
def test_what_is_found_by_other_means_cannot_be_reported(
    core: Supervision, part: PartName | None, error: str, why: type[PilothouseError]
) -> None:
    with pytest.raises(why):
        report(core, part=part, error=error)
    assert not jammed(core).state.is_on
