"""Processes of nodes, as an operator sees that they run, end, and are given up."""

from dataclasses import replace

import pytest

from domain.actor import Actor
from domain.commands import Command, StartProcess, StopProcess
from domain.errors import ProcessElsewhereError, UnknownPartError, UnknownProcessError
from domain.events.event import RecordedEvent
from domain.inputs import Input, NodeReport, Restored, TimePassed
from domain.kept import Kept
from domain.process_terms import (
    ProcessAction,
    ProcessExit,
    ProcessReport,
    ProcessRequest,
    ProcessState,
    RestartPolicy,
)
from domain.processes.process_view import ProcessView
from domain.processes.settings import ProcessSettings
from domain.snapshot import ErrorKey, ErrorView
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.models import ARM, BASE, actuation_model

ENDED, GIVEN_UP = "PROCESS_ENDED", "PROCESS_GIVEN_UP"
SETTINGS = ProcessSettings(
    first_back_off=seconds(1), most_back_off=seconds(4), starts=3, within=seconds(60)
)
CRASH = ProcessExit(signal="SIGSEGV")
DONE = ProcessExit(0)


class Robot:
    """A robot whose drive base has a process; its time moves only when told to."""

    def __init__(self, settings: ProcessSettings = SETTINGS, *kept: Kept) -> None:
        self.now = seconds(100)
        processes = {BASE: settings}
        self.core = Supervision(
            actuation_model(), SupervisionSettings(processes=processes), self.now
        )
        self.events: list[RecordedEvent] = []
        self.commands: list[Command] = []
        self.kept: dict[str, Kept] = {}
        self._pid = 4000
        if kept:
            self.give(Restored(kept, boot=2))

    def give(self, given: Input) -> None:
        outputs = self.core.handle(given, self.now)
        self.events += outputs.events
        self.commands += outputs.commands
        for keeping in outputs.kept:
            if keeping.value is None:
                self.kept.pop(keeping.name, None)
            else:
                self.kept[keeping.name] = keeping.value

    def advance(self, by_s: float) -> None:
        self.now += seconds(by_s)
        self.give(TimePassed())

    def is_ready(self) -> None:
        self.give(ProcessReport(BASE))

    def runs(self) -> None:
        self._pid += 1
        self.give(ProcessReport(BASE, self._pid))

    def ends(self, end: ProcessExit = CRASH) -> None:
        self.give(ProcessReport(BASE, exit=end))

    def ask(self, action: ProcessAction) -> None:
        self.give(ProcessRequest(BASE, action, Actor("ada")))

    def sent(self) -> list[Command]:
        """Return what was commanded since the last call."""
        sent, self.commands = self.commands, []
        return sent

    @property
    def view(self) -> ProcessView:
        return self.core.processes.view(BASE)

    @property
    def state(self) -> ProcessState:
        return self.view.state

    @property
    def on(self) -> list[str]:
        """Return the errors of the process that are on."""
        return [error for error in (ENDED, GIVEN_UP) if self.error(error).state == "active"]

    def error(self, error: str) -> ErrorView:
        return self.core.error(ErrorKey(BASE, error))

    def kinds(self) -> list[str]:
        return [event.kind for event in self.events]


@pytest.fixture
def robot() -> Robot:
    """Return a robot whose process has run for a while."""
    robot = Robot()
    robot.is_ready()
    robot.runs()
    robot.advance(2)
    robot.sent()
    return robot


# --- a process that runs -------------------------------------------------------------------------


def test_a_process_is_started_once_it_can_be() -> None:
    robot = Robot()
    robot.advance(5)
    assert robot.sent() == []

    robot.is_ready()

    assert (robot.sent(), robot.state) == ([StartProcess(BASE)], ProcessState.STARTING)


def test_a_process_that_runs_is_no_error(robot: Robot) -> None:
    assert (robot.state, robot.view.pid, robot.on) == (ProcessState.RUNNING, 4001, [])
    assert robot.kinds() == ["process.ready", "process.started"]


# --- a process that ends -------------------------------------------------------------------------


def test_a_crash_is_an_error_and_the_process_is_started_again(robot: Robot) -> None:
    robot.ends()

    assert (robot.state, robot.on) == (ProcessState.WAITING, [ENDED])
    assert robot.error(ENDED).message == "the process of drive_base ended: ended by SIGSEGV"
    assert robot.view.next_start == robot.now + seconds(1)

    robot.advance(1)

    assert (robot.sent(), robot.state) == ([StartProcess(BASE)], ProcessState.STARTING)


def test_the_error_clears_when_the_next_process_has_run_for_a_second(robot: Robot) -> None:
    robot.ends()
    robot.advance(1)
    robot.runs()
    robot.advance(0.9)
    assert robot.on == [ENDED]

    robot.advance(0.1)

    assert (robot.on, robot.view.exit) == ([], CRASH)


def test_each_back_off_is_twice_the_last_up_to_the_longest() -> None:
    robot = Robot(replace(SETTINGS, starts=10))
    robot.is_ready()
    waited = []
    for _ in range(4):
        robot.runs()
        robot.ends()
        assert robot.view.next_start is not None
        waited.append(robot.view.next_start - robot.now)
        robot.advance(4)

    assert waited == [seconds(1), seconds(2), seconds(4), seconds(4)]


def test_the_back_off_begins_anew_after_a_long_run() -> None:
    robot = Robot(replace(SETTINGS, starts=10))
    robot.is_ready()
    for _ in range(3):
        robot.runs()
        robot.ends()
        robot.advance(4)
    robot.runs()
    robot.advance(4)
    robot.ends()

    assert robot.view.next_start == robot.now + seconds(1)


def test_a_process_that_cannot_be_started_is_told_why() -> None:
    robot = Robot()
    robot.is_ready()
    robot.ends(ProcessExit(127, reason="the command was not found"))

    assert robot.error(ENDED).message.endswith("ended: the command was not found")
    assert robot.state is ProcessState.WAITING


@pytest.mark.parametrize(
    ("policy", "end", "state"),
    [
        (RestartPolicy.ON_FAILURE, DONE, ProcessState.ENDED),
        (RestartPolicy.ON_FAILURE, ProcessExit(1), ProcessState.WAITING),
        (RestartPolicy.ALWAYS, DONE, ProcessState.WAITING),
        (RestartPolicy.NEVER, CRASH, ProcessState.ENDED),
    ],
)
def test_it_is_started_again_after_the_ends_that_the_robot_file_says(
    policy: RestartPolicy, end: ProcessExit, state: ProcessState
) -> None:
    robot = Robot(replace(SETTINGS, restart=policy))
    robot.is_ready()
    robot.runs()
    robot.ends(end)
    robot.advance(30)

    assert robot.on == [ENDED], "nobody asked for the end"
    assert robot.state is (ProcessState.STARTING if state is ProcessState.WAITING else state)


def test_a_node_that_is_unreachable_since_its_process_ended_says_so(robot: Robot) -> None:
    robot.give(NodeReport(BASE, reachable=True))
    robot.ends()
    robot.give(NodeReport(BASE, reachable=False))

    unreachable = robot.error("UNREACHABLE")
    assert unreachable.roots == (ErrorKey(BASE, ENDED),)


# --- a process that ends too often ---------------------------------------------------------------


def crash_until_given_up(robot: Robot) -> None:
    robot.ends()
    while robot.state is not ProcessState.GIVEN_UP:
        robot.advance(4)
        robot.runs()
        robot.ends()


def test_a_process_that_ends_too_often_is_given_up(robot: Robot) -> None:
    crash_until_given_up(robot)
    robot.advance(300)

    assert (robot.sent(), robot.on) == ([StartProcess(BASE)] * 2, [GIVEN_UP])
    assert "process.given_up" in robot.kinds()
    assert robot.error(GIVEN_UP).message == "the process of drive_base ended: ended by SIGSEGV"


def test_starts_that_are_long_ago_do_not_count() -> None:
    robot = Robot()
    robot.is_ready()
    for _ in range(10):
        robot.runs()
        robot.advance(30)
        robot.ends()
        robot.advance(4)

    assert (robot.state, robot.view.starts_left) == (ProcessState.STARTING, 1)


def test_an_operator_starts_what_was_given_up_with_a_whole_budget(robot: Robot) -> None:
    crash_until_given_up(robot)
    robot.sent()

    robot.ask(ProcessAction.START)

    assert (robot.sent(), robot.on) == ([StartProcess(BASE)], [])
    assert robot.view.starts_left == 2


# --- what operators ask --------------------------------------------------------------------------


def test_an_operator_stops_a_process_and_that_is_no_error(robot: Robot) -> None:
    robot.ask(ProcessAction.STOP)
    assert (robot.sent(), robot.state) == ([StopProcess(BASE)], ProcessState.STOPPING)

    robot.ends(ProcessExit(signal="SIGINT"))
    robot.advance(100)

    assert (robot.sent(), robot.state, robot.on) == ([], ProcessState.STOPPED, [])


def test_an_operator_restarts_a_process(robot: Robot) -> None:
    robot.ask(ProcessAction.RESTART)
    assert robot.sent() == [StopProcess(BASE)]

    robot.ends(ProcessExit(signal="SIGINT"))

    assert (robot.sent(), robot.on) == ([StartProcess(BASE)], [])


def test_a_process_that_is_started_while_it_stops_is_started_when_it_has_ended(
    robot: Robot,
) -> None:
    robot.ask(ProcessAction.STOP)
    robot.ask(ProcessAction.START)
    assert robot.sent() == [StopProcess(BASE)]

    robot.ends(DONE)

    assert robot.sent() == [StartProcess(BASE)]


def test_a_stop_before_it_runs_ends_it_as_soon_as_it_does() -> None:
    robot = Robot()
    robot.is_ready()
    robot.ask(ProcessAction.STOP)
    robot.runs()

    assert robot.state is ProcessState.STOPPING
    assert robot.sent() == [StartProcess(BASE), StopProcess(BASE)]


def test_a_stop_ends_the_wait_for_the_next_start(robot: Robot) -> None:
    robot.ends()
    robot.ask(ProcessAction.STOP)
    robot.advance(100)

    assert (robot.sent(), robot.state, robot.on) == ([], ProcessState.STOPPED, [])


def test_to_start_what_runs_changes_nothing(robot: Robot) -> None:
    robot.ask(ProcessAction.START)

    assert (robot.sent(), robot.state) == ([], ProcessState.RUNNING)


def test_who_asked_is_on_record(robot: Robot) -> None:
    robot.ask(ProcessAction.STOP)

    asked = robot.events[-1]
    assert (asked.kind, asked.actor.name) == ("process.requested", "ada")
    assert asked.data == {"node": "drive_base", "action": "stop"}


def test_where_nothing_runs_processes_none_can_be_asked_for() -> None:
    robot = Robot()

    with pytest.raises(ProcessElsewhereError):
        robot.ask(ProcessAction.START)
    assert (robot.sent(), robot.state) == ([], ProcessState.NOT_RUN_HERE)


@pytest.mark.parametrize(
    ("node", "error"), [(ARM, UnknownProcessError), (PartName("nowhere"), UnknownPartError)]
)
def test_a_node_without_a_process_has_none(node: PartName, error: type[Exception]) -> None:
    robot = Robot()

    with pytest.raises(error):
        robot.give(ProcessRequest(node, ProcessAction.STOP))


# --- over a restart of the service ---------------------------------------------------------------


def restarted(robot: Robot) -> Robot:
    """Return the robot after its service was started again."""
    later = Robot(SETTINGS, *robot.kept.values())
    later.is_ready()
    return later


def test_what_an_operator_stopped_stays_so_over_a_restart(robot: Robot) -> None:
    robot.ask(ProcessAction.STOP)
    robot.ends(DONE)

    later = restarted(robot)

    assert (later.sent(), later.state) == ([], ProcessState.STOPPED)


def test_what_was_given_up_stays_so_over_a_restart(robot: Robot) -> None:
    crash_until_given_up(robot)

    later = restarted(robot)

    assert (later.sent(), later.state) == ([], ProcessState.GIVEN_UP)
    assert later.on == [GIVEN_UP]


def test_a_restart_gives_no_new_starts(robot: Robot) -> None:
    robot.ends()
    robot.advance(1)
    assert robot.view.starts_left == 1

    later = restarted(robot)

    assert (later.sent(), later.view.starts_left) == ([StartProcess(BASE)], 0)


def test_of_a_process_that_runs_well_nothing_is_kept(robot: Robot) -> None:
    assert robot.kept
    robot.advance(60)

    assert robot.kept == {}


def test_what_is_kept_of_a_node_without_a_process_is_forgotten(robot: Robot) -> None:
    robot.ask(ProcessAction.STOP)
    core = Supervision(actuation_model(), SupervisionSettings(), 0)

    outputs = core.handle(Restored(tuple(robot.kept.values()), boot=2), 0)

    assert [(keeping.name, keeping.value) for keeping in outputs.kept] == [("drive_base", None)]
