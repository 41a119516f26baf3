"""When a device tells what."""

from domain.computers import Incarnation, Session
from domain.inputs import NodeAnswer, NodeReport, Reading, Readings
from domain.lifecycle import LifecycleState
from domain.link.messages import Report, Told
from domain.link.peer import Own
from domain.link.reporting import Reporting
from domain.link.settings import LinkSettings
from domain.timebase import seconds
from tests.support.linked_pair import BASE, DRIVE, TERMS

S = LifecycleState
ACTIVE = NodeReport(DRIVE, S.ACTIVE, reachable=True)
INACTIVE = NodeReport(DRIVE, S.INACTIVE, reachable=True)
SESSION = Session("s")


class Hearing:
    """Reporting to a supervisor that hears it from 0 s on; the node is inactive."""

    def __init__(self) -> None:
        self.reporting = Reporting(Own(BASE, Incarnation("i"), TERMS), LinkSettings())
        self.reporting.note(INACTIVE, 0, is_heard=False)
        self.reporting.begin(0)

    def note(self, told: Told, at_s: float) -> None:
        self.reporting.note(told, seconds(at_s), is_heard=True)

    def at(self, at_s: float) -> list[Report]:
        return list(self.reporting.reports(SESSION, seconds(at_s)))

    def due(self) -> float | None:
        at = self.reporting.wake_at()
        return None if at is None else at / 1e9


def test_everything_is_told_at_once_and_then_each_second() -> None:
    told = Hearing()
    first = Report(BASE, Incarnation("i"), 1, (INACTIVE,), complete=True, session=SESSION)

    assert told.due() == 0
    assert told.at(0) == [first]
    assert told.due() == 1
    assert told.at(0.5) == []
    assert told.at(1)[0].seq == 2


def test_changes_of_one_moment_go_in_one_report_at_once() -> None:
    told = Hearing()
    told.at(0)
    told.note(ACTIVE, 0.3)
    told.note(NodeAnswer(1, DRIVE, True), 0.3)

    assert told.due() == 0.3
    (report,) = told.at(0.3)
    assert (report.items, report.complete) == ((ACTIVE, NodeAnswer(1, DRIVE, True)), False)
    assert told.due() == 1


def test_a_change_goes_before_everything() -> None:
    told = Hearing()
    told.note(ACTIVE, 0)

    assert [report.complete for report in told.at(0)] == [False, True]


def test_ages_are_sent_instead_of_times() -> None:
    told = Hearing()
    told.at(0)
    told.note(Readings((Reading("load", 0.1),), "can"), 0.4)
    (at_once,) = told.at(0.4)
    (complete,) = told.at(1)

    assert at_once.items == (Readings((Reading("load", 0.1),), "can"),)
    assert complete.items[-1] == Readings((Reading("load", 0.1, seconds(-0.6)),), "can")


def test_a_supervisor_that_missed_everything_gets_it_soon_but_not_with_each_beat() -> None:
    told = Hearing()
    told.at(0)
    told.reporting.ask_all(seconds(0.1), at_once=False)

    assert told.due() == 0.5
    told.at(0.5)
    told.reporting.ask_all(seconds(0.6), at_once=True)
    assert told.due() == 0.6


def test_nothing_is_told_while_nobody_hears_it() -> None:
    told = Hearing()
    told.note(ACTIVE, 0)
    told.reporting.stop()
    told.reporting.ask_all(0, at_once=True)
    told.note(INACTIVE, 1)

    assert told.due() is None
    assert told.at(1) == []
    told.reporting.begin(seconds(2))
    assert [report.items for report in told.at(2)] == [(INACTIVE,)]


def test_more_changes_than_fit_are_told_as_everything() -> None:
    told = Hearing()
    told.at(0)
    for _ in range(5_000):
        told.note(ACTIVE, 0.1)

    reports = told.at(0.1)
    assert [report.complete for report in reports] == [False, True]
    assert len(reports[0].items) < 1_000
