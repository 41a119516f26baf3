import functools
import os
import pickle
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from domain.commands import Drive
from domain.conditions.condition import Condition
from domain.health.signals import default_signals
from domain.inputs import (
    EmergencyStopRequest,
    HoldRequest,
    Input,
    Reading,
    Readings,
    TaskRequest,
    TimePassed,
)
from domain.onboard import Onboard
from domain.outbox import Outbox
from domain.parts.mode_settings import ModeSettings, OnFailure, TransitionSettings
from domain.parts.system_model import EVERY_MODE, SmhModel
from domain.paths.path import Path
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from domain.windows.settings import Statistic
from service.checkpoint import CheckpointError, checkpoint_of, core_of_checkpoint
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.models import (
    ACTUATION,
    ARM,
    BASE,
    PERFORMANCE,
    actuation_model,
    nested_model,
)
from tests.support.watched_robot import above, monitor, signal

HEAD = b"pilothouse checkpoint 1.2\n"


def driving() -> CoreRobot:
    """Return a robot in the middle of a task."""
    robot = CoreRobot(nested_model())
    robot.read(**GOOD)
    robot.advance(1)
    path = Path(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [20.0, 1.0, 0.0]]))
    robot.give(TaskRequest(path, 0, "stanley", 2.0))
    robot.advance(1.5)
    return robot


def test_a_copy_goes_on_as_the_core_does() -> None:
    robot = driving()

    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1.2"), "1.2")

    inputs: list[Input] = [TimePassed(), HoldRequest("ada", "pause"), TimePassed()]
    for after_s, given in enumerate(inputs):
        at = robot.now + seconds(after_s * 0.3)
        outputs = robot.onboard.handle(given, at)
        assert copy.handle(given, at) == outputs
        assert copy.wake_at() == robot.onboard.wake_at()
    assert any(isinstance(command, Drive) for command in outputs.commands)


@pytest.mark.parametrize("statistic", Statistic)
def test_a_copy_computes_monitors_bit_for_bit(statistic: Statistic) -> None:
    watched = monitor(statistic, above(5), window_s=2.0)
    robot = CoreRobot(
        actuation_model(), SupervisionSettings((*default_signals(), signal(), watched))
    )
    rng = random.Random(1)
    for _ in range(50):
        robot.read(load=1e6 + rng.random())
        robot.advance(rng.choice([0.01, 0.1, 0.3]))

    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1.2"), "1.2")

    for step in range(50):
        given = Readings((Reading("load", 1e6 + rng.random()),), "test")
        at = robot.now + seconds(0.07 * step)
        assert copy.handle(given, at) == robot.onboard.handle(given, at)
        assert copy.core.monitors() == robot.onboard.core.monitors()
        assert copy.wake_at() == robot.onboard.wake_at()


def test_a_copy_has_the_settings_of_modes() -> None:
    model = actuation_model()
    transition = TransitionSettings({BASE: (ARM,)}, seconds(20), OnFailure.ROLLBACK)
    guarded = ModeSettings((Condition("battery_level > 0.3"),), transition=transition)
    settings = {ACTUATION: {PERFORMANCE: guarded, EVERY_MODE: ModeSettings()}}
    robot = CoreRobot(SmhModel(model.nodes, model.systems, settings))

    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1.2"), "1.2")

    assert copy.core.model.mode_settings == settings


def test_a_copy_shares_nothing_with_the_core() -> None:
    robot = driving()
    copy = core_of_checkpoint(checkpoint_of(robot.onboard, "1.2"), "1.2")

    copy.handle(EmergencyStopRequest(True, "smoke"), robot.now)

    assert copy.core.emergency_stop().engaged
    assert not robot.core.emergency_stop().engaged


@pytest.mark.parametrize(
    ("checkpoint", "message"),
    [
        (b"", "no checkpoint"),
        (b"\x80\x05N.", "no checkpoint"),
        (HEAD.replace(b"1.2", b"1.1"), "release 1.1 wrote this checkpoint; this is 1.2"),
        (HEAD, "is broken"),
        (HEAD + b"\x80\x05\x95\xff", "is broken"),
        (HEAD + pickle.dumps(None), "holds no core"),
        (HEAD + pickle.dumps({1: [2.5, "a", (True, None)]}), "holds no core"),
        (HEAD + b"cdomain.onboard\nOnboard\n.", "holds no core"),
        (HEAD + b"cdomain.onboard\nOnboard\n)R.", "is broken"),
    ],
)
def test_what_is_no_checkpoint_of_this_release_is_rejected(checkpoint: bytes, message: str) -> None:
    with pytest.raises(CheckpointError, match=message):
        core_of_checkpoint(checkpoint, "1.2")


def test_a_checkpoint_that_was_cut_off_is_rejected() -> None:
    checkpoint = checkpoint_of(driving().onboard, "1.2")
    for length in range(0, len(checkpoint), 97):
        with pytest.raises(CheckpointError):
            core_of_checkpoint(checkpoint[:length], "1.2")


class Calls:
    """Pickles as a call."""

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[object, ...]]:
        return self._call


@pytest.mark.parametrize(
    "hostile",
    [
        pickle.dumps(Calls(os.system, "touch hostile")),
        pickle.dumps(Calls(eval, "1")),
        pickle.dumps(Calls(getattr, Outbox, "keep")),
        pickle.dumps(Calls(functools.partial, print)),
        pickle.dumps(Calls(pickle.loads, b"N.")),
        pickle.dumps(Calls(np.load, "x")),
        pickle.dumps(ValueError("x")),
        pickle.dumps(HEAD.decode),
        b"cdomain.paths.path\nnp.load\n.",
        b"cdomain.paths.path\nnp\n.",
        b"cdomain.paths.path\nhypot\n.",
        b"cdomain.outbox\nOutbox.keep\n.",
        b"cdomain.simulation.robot\n__builtins__\n.",
        b"cdomain.outbox\ndataclass\n.",
        b"cdomain.outbox\nActor\n.",
        b"cdomain\nos\n.",
        b"cservice.worker\nWorker\n.",
        b"cos\nsystem\n(S'touch hostile'\ntR.",
        b"cservice.checkpoint\nmethod_of\n(cdomain.outbox\nOutbox\nS'__subclasses__'\ntR.",
        b"cservice.checkpoint\nmethod_of\n(cdomain.outbox\nOutbox\n)RS'__class__'\ntR.",
        b"cservice.checkpoint\nmethod_of\n(](S'append'\ntR.",
    ],
)
def test_a_hostile_pickle_runs_nothing(
    hostile: bytes, tmp_path: os.PathLike[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    with pytest.raises(CheckpointError, match=r"cannot hold|is broken"):
        core_of_checkpoint(HEAD + hostile, "1.2")

    assert os.listdir(tmp_path) == []


def test_a_hostile_pickle_cannot_change_a_class() -> None:
    before = Onboard.handle
    # BUILD with the state of slots sets attributes of the class itself.
    patch = b"\x80\x02cdomain.onboard\nOnboard\n(N}(U\x06handleU\x01xU\x03newK\x01utb."

    with pytest.raises(CheckpointError, match="cannot change Onboard"):
        core_of_checkpoint(HEAD + patch, "1.2")

    assert Onboard.handle is before
    assert not hasattr(Onboard, "new")
