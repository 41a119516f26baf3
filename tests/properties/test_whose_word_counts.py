"""Random stories of one device: orders, cuts, stops, faults, and people beside it.

`make soak` tells 5,000 stories, `make test` 60.
"""

import os
from collections.abc import Callable, Sequence
from contextlib import suppress

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from domain.commands import AnswerOrder, AskParameters, AskTransition, Command
from domain.computers import DeviceState
from domain.devices.lead_view import Word
from domain.errors import PilothouseError
from domain.inputs import Input, SupervisorStatus
from domain.lifecycle import Transition
from domain.outbox import Outputs
from domain.simulation.node_settings import Fault
from domain.timebase import Instant
from tests.support.device_robot import FIRST, SECOND, DeviceRobot, offline
from tests.support.live_robot import make_onboard
from tests.support.models import BASE

SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
STORIES = 5_000 if SOAK else 60
DOES = (
    offline(),
    offline(drive_base="inactive"),
    offline(after_s=5, drive_base="active.SLOW"),
    offline(drive_base="unconfigured", reactions=True),
)


class WatchedRobot(DeviceRobot):
    """A device of which each command to its node is looked at when it is given."""

    def __init__(self, number: int) -> None:
        self.given: list[tuple[Input, Instant, Outputs | None]] = []
        self.deactivated_here = False
        super().__init__(DOES[number])

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and check what it asks of the node."""
        before = len(self.commands)
        self.given.append((given, self.now, None))
        try:
            outputs = super().give(given)
        finally:
            self._check(self.commands[before:])
        self.given[-1] = (given, self.now, outputs)
        answers = [told for told in self.told if isinstance(told, AnswerOrder)]
        assert len({told.request for told in answers}) == len(answers), "answered twice"
        return outputs

    def _check(self, commands: Sequence[Command]) -> None:
        for command in commands:
            if not isinstance(command, AskTransition | AskParameters):
                continue
            if isinstance(command, AskTransition) and command.transition is Transition.ACTIVATE:
                assert not self.core.emergency_stop().engaged, "activated under a stop"
            assert self.deactivated_here or self.lead.word in (Word.SUPERVISOR, Word.DEVICE)

    def deactivate(self) -> None:
        """Let somebody beside the robot deactivate it."""
        self.deactivated_here = True
        self.ask_transition("drive_base", "deactivate")


def _status(state: DeviceState, incarnation: object = FIRST) -> Callable[[WatchedRobot], object]:
    return lambda robot: robot.give(SupervisorStatus(state, "test", incarnation))  # type: ignore[arg-type]


HAPPENINGS: dict[str, Callable[[WatchedRobot], object]] = {
    "connect": _status(DeviceState.CONNECTED),
    "connect to another": _status(DeviceState.CONNECTED, SECOND),
    "late": _status(DeviceState.LATE),
    "lost": _status(DeviceState.LOST),
    "conflict": _status(DeviceState.CONFLICT),
    "order configure": lambda robot: robot.order("drive_base", "configure"),
    "order activate": lambda robot: robot.order("drive_base", "activate"),
    "order deactivate": lambda robot: robot.order("drive_base", "deactivate"),
    "order cleanup": lambda robot: robot.order("drive_base", "cleanup"),
    "order speed": lambda robot: robot.order("drive_base", {"max_speed": 0.9}),
    "order elsewhere": lambda robot: robot.order("manipulator", "activate"),
    "stop": lambda robot: robot.stop(),
    "release": lambda robot: robot.release_stop(),
    "ask mode": lambda robot: robot.ask_mode("drive_base", "FAST"),
    "deactivate": lambda robot: robot.deactivate(),
    "refuse": lambda robot: robot.fault("drive_base", Fault.REFUSE),
    "die": lambda robot: robot.fault("drive_base", Fault.DIE),
    "recover": lambda robot: robot.fault("drive_base", None),
}
STEPS = st.lists(
    st.tuples(st.sampled_from(sorted(HAPPENINGS)), st.sampled_from((0.0, 0.1, 0.5, 2.0, 6.0))),
    max_size=25,
)


def told(number: int, steps: list[tuple[str, float]]) -> WatchedRobot:
    """Tell a story."""
    robot = WatchedRobot(number)
    for name, wait_s in steps:
        with suppress(PilothouseError):
            HAPPENINGS[name](robot)
        robot.advance(wait_s)
    return robot


@pytest.mark.timeout(0 if SOAK else 300)
@settings(max_examples=STORIES)
@given(st.sampled_from(range(len(DOES))), STEPS)
def test_a_node_is_commanded_only_by_whose_word_counts(
    number: int, steps: list[tuple[str, float]]
) -> None:
    robot = told(number, steps)

    # Once the supervisor is back and nothing else happens, the device wants nothing itself.
    robot.fault("drive_base", None)
    robot.lose()
    robot.connect()
    robot.advance(15)
    assert robot.core.part(BASE).target is None
    commands = len(robot.commands)
    robot.advance(15)
    assert len(robot.commands) == commands


@pytest.mark.timeout(0 if SOAK else 300)
@settings(max_examples=STORIES // 3)
@given(st.sampled_from(range(len(DOES))), STEPS)
def test_a_record_of_a_device_leads_where_it_led_then(
    number: int, steps: list[tuple[str, float]]
) -> None:
    robot = told(number, steps)
    replayed = make_onboard(robot.model, 0, robot.settings)

    for given_then, at, outputs in robot.given:
        if outputs is None:
            with pytest.raises(PilothouseError):
                replayed.handle(given_then, at)
        else:
            assert replayed.handle(given_then, at) == outputs
    assert replayed.core.lead() == robot.core.lead()
