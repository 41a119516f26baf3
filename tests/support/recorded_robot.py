"""A robot that is recorded as the live service does it, and whatever may happen to it."""

from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from random import Random

import numpy as np

from domain.actor import Actor
from domain.commands import Drive, NodeCommand
from domain.errors import PilothouseError
from domain.inputs import (
    BackendStatus,
    DriveStatus,
    Input,
    ModeRequest,
    ParametersRequest,
    ReportBacklog,
    Restored,
    ServiceStall,
    SignalValue,
    SourceFault,
    StorageStatus,
    TimePassed,
    TransitionRequest,
    WriteRecord,
)
from domain.kept import Kept
from domain.lifecycle import Transition
from domain.onboard import Onboard
from domain.outbox import Outputs
from domain.parameters import Parameters
from domain.paths.path import Path
from domain.simulation.node_settings import Fault
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from domain.tracking.trackers import TRACKERS
from service.codec.codec import STEPS
from service.codec.recorded_step import RecordedStep, recorded_step
from service.files.model_file import read_model
from service.files.robot_file import read_robot_file
from service.storage.journal import Boot, Step
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import nested_model
from tests.support.random_models import model_text

BOOT = Boot(
    epoch="recorded",
    version="1.2",
    started_at=1_764_420_000_123_456_789,
    wall_at=datetime(2026, 1, 1, tzinfo=UTC),
    model=model_text(nested_model()),
    robot="nodes: {drive_base: {on_return: restore}}\nchanges: {transition_deadline_s: 4}\n",
)
ADA = Actor("ada", "http", "10.0.0.7")


class RecordedRobot(CoreRobot):
    """A robot whose core is recorded from its first input on."""

    def __init__(self, boot: Boot = BOOT, restored: tuple[Kept, ...] = ()) -> None:
        self.taken: list[Step] = []
        self.is_late = False
        """Whether the loop is late, so that inputs come before what was due."""
        first = Restored(restored, boot=2, next_event=10_001) if restored else Restored()
        self._first: Input | None = first
        model = read_model(boot.model).model
        robot = read_robot_file(boot.robot, model)
        settings = SupervisionSettings(
            robot.to_signal_settings(),
            robot.to_change_settings(),
            robot.to_task_settings(),
            robot.to_vehicle_limits(),
            robot.to_rule_settings(),
        )
        super().__init__(model, settings, start=boot.started_at)

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, note the step, and hand to the robot what the core asks."""
        if self._first is not None:
            first, self._first = self._first, None
            self.give(first)
        handle = self.onboard.take_in if self.is_late else self.onboard.handle
        try:
            return self._took(given, handle(given, self.now))
        except PilothouseError:
            # As the live service does: what was due before a rejected input is told.
            self._took(TimePassed(), handle(TimePassed(), self.now))
            raise

    def _took(self, given: Input, outputs: Outputs) -> Outputs:
        self.taken.append(Step(self.now, given, self.is_late, outputs))
        self.events += outputs.events
        for command in outputs.commands:
            self.commands.append(command)
            assert isinstance(command, NodeCommand | Drive), "goals stay on board"
            self.robot.handle(command, self.now)
        return outputs

    @property
    def record(self) -> list[bytes]:
        """Return the steps as they are stored."""
        return [
            STEPS.encode(recorded_step(s.at, s.given, s.is_late, s.outputs)) for s in self.taken
        ]

    def recorded(self) -> list[RecordedStep]:
        """Return what was recorded, as it is read."""
        return [STEPS.decode(step) for step in self.record]

    def kept(self) -> tuple[Kept, ...]:
        """Return what a restart would bring back."""
        kept = {}
        for step in self.recorded():
            kept.update({(keeping.kind, keeping.name): keeping.value for keeping in step.kept})
        return tuple(value for value in kept.values() if value is not None)

    def stall(self, duration_s: float, *given: Input) -> None:
        """Let the loop do nothing for a while, and then take in what arrived meanwhile."""
        self.now += seconds(duration_s)
        self.is_late = True
        for item in given:
            self.give(item)
        self.is_late = False
        self.give(ServiceStall(seconds(duration_s)))


def live(seed: int, happenings: int = 40) -> RecordedRobot:
    """Return a robot to which whatever may happen did; every other one goes on from an earlier run.

    Args:
        seed: Tells one run from another.
        happenings: How much happened.
    """
    rng = Random(seed)
    robot = RecordedRobot()
    if seed % 2:
        _let_happen(robot, rng, happenings // 4)
        robot = RecordedRobot(BOOT, robot.kept())
    _let_happen(robot, rng, happenings)
    return robot


def _let_happen(robot: RecordedRobot, rng: Random, happenings: int) -> None:
    for _ in range(happenings):
        if rng.random() < 0.7:
            robot.read(**GOOD)
        # Some are rejected, which is recorded as well.
        with suppress(PilothouseError):
            rng.choice(HAPPENINGS)(robot, rng)
        robot.advance(rng.choice((0.0, 0.01, 0.1, 0.4, 2.5)))


def _read(robot: RecordedRobot, rng: Random) -> None:
    values = dict(GOOD)
    if rng.random() < 0.5:
        name = rng.choice(sorted(values))
        bad: dict[str, SignalValue] = {"estop": True, "signal_strength": "LOST"}
        values[name] = bad.get(name, rng.choice((0.0, 99.5)))
    robot.read(**values)


def _drive(robot: RecordedRobot, rng: Random) -> None:
    xs = np.linspace(0.0, rng.uniform(3.0, 40.0), rng.randrange(2, 30))
    rows = np.column_stack((xs, np.sin(xs / 9.0) * rng.uniform(0.0, 2.0), np.zeros_like(xs)))
    controller = rng.choice(sorted(TRACKERS))
    robot.submit_task(Path(rows), controller=controller, speed_mps=rng.choice((0.5, 1.5, 2.8)))


def _ask(robot: RecordedRobot, rng: Random) -> None:
    part = rng.choice(robot.model.parts)
    kind = rng.randrange(3)
    if kind == 0:
        robot.give(ModeRequest(part, rng.choice([*robot.model.modes_of(part), "NO_SUCH"]), ADA))
    elif kind == 1:
        robot.give(TransitionRequest(part, rng.choice(list(Transition)), ADA))
    else:
        values: Parameters = {"max_speed": rng.choice((0.25, 1.0)), "controller": "PID"}
        robot.give(ParametersRequest(PartName("drive_base"), values, ADA))


def _break_or_mend(robot: RecordedRobot, rng: Random) -> None:
    robot.fault(rng.choice(sorted(robot.model.nodes)), rng.choice([None, *Fault]))


HAPPENINGS: tuple[Callable[[RecordedRobot, Random], object], ...] = (
    *(_read, _drive, _ask) * 4,
    *(_break_or_mend,) * 2,
    lambda robot, rng: robot.stop(),
    *(lambda robot, rng: robot.release_stop(),) * 3,
    lambda robot, rng: robot.hold(rng.choice(("gate", "operator"))),
    *(lambda robot, rng: robot.release(rng.choice(("gate", "operator"))),) * 3,
    lambda robot, rng: robot.cancel_task(),
    *(lambda robot, rng: robot.acknowledge("ESTOP"),) * 3,
    lambda robot, rng: robot.lose_pose(lost=rng.random() < 0.3),
    lambda robot, rng: robot.give(BackendStatus(rng.random() < 0.7, "no network")),
    lambda robot, rng: robot.give(DriveStatus(rng.random() < 0.7, "no driver")),
    lambda robot, rng: robot.give(
        SourceFault("temperature", rng.choice(["a", "b"]), rng.choice(["no bus", "no file"]))
    ),
    lambda robot, rng: robot.give(StorageStatus(rng.random() < 0.5, "disk full")),
    lambda robot, rng: robot.give(ReportBacklog("ros", rng.choice((None, robot.now)))),
    lambda robot, rng: robot.give(WriteRecord("POST", "/tasks", 201, "10.0.0.7:5", ADA)),
    lambda robot, rng: robot.stall(rng.uniform(0.1, 3.0), TimePassed()),
)


def views_of(onboard: Onboard) -> tuple[object, ...]:
    """Return all that an operator sees of a core, and when it wakes up next."""
    core = onboard.core
    return (
        onboard.wake_at(),
        core.parts(),
        core.changes(),
        core.signals(),
        core.system_state(),
        core.emergency_stop(),
        tuple(core.driving.tasks()),
        core.driving.vehicle,
        core.driving.holds,
    )
