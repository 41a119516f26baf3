from collections.abc import Callable, Iterable
from dataclasses import replace
from inspect import isawaitable
from typing import Any

import pytest

from domain.health.signals import Recovery, default_signals
from domain.supervision import SupervisionSettings
from service.files.model_file import read_model
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD
from tests.support.http_operator import HttpOperator
from tests.support.http_robot import ACTUATION, HttpRobot, http_robot
from tests.support.operator_verbs import OperatorVerbs
from tests.support.service_operator import ServiceOperator

Verbs = OperatorVerbs[Any, Any, Any]

ACKNOWLEDGED = SupervisionSettings(
    tuple(
        replace(signal, recovery=Recovery.ACKNOWLEDGE, stale_after=0)
        for signal in default_signals()
    )
)
"""No signal becomes stale, and every error waits for acknowledgement."""
OFTEN = {"audit.write", "node.answered", "signal.read", "task.progress", "vehicle.reported"}
STORY: list[Callable[[Verbs], Any]] = [
    lambda operator: operator.read(**GOOD),
    lambda operator: operator.ask_transition("drive_base", "configure"),
    lambda operator: operator.ask_mode("actuation", "PERFORMANCE"),
    lambda operator: operator.submit_task(),
    lambda operator: operator.hold(),
    lambda operator: operator.release(),
    lambda operator: operator.stop(),
    lambda operator: operator.release_stop(),
    lambda operator: operator.acknowledge("ESTOP"),
    lambda operator: operator.cancel_task(),
]


def kinds(events: Iterable[Any]) -> list[str]:
    return [event.kind for event in events if event.kind not in OFTEN]


async def tell(operator: Verbs) -> None:
    for act in STORY:
        for told in (act(operator), operator.advance(1.0)):
            if isawaitable(told):
                await told


def in_service(robot: HttpRobot) -> Verbs:
    return ServiceOperator(robot.supervisor, robot.clock)


@pytest.mark.parametrize("operator_of", [in_service, HttpOperator])
async def test_every_verb_does_what_it_does_in_the_core(
    operator_of: Callable[[HttpRobot], Verbs],
) -> None:
    core = CoreRobot(read_model(ACTUATION).model, ACKNOWLEDGED)
    await tell(core)
    async with http_robot(mock=False, settings=ACKNOWLEDGED) as robot:
        await tell(operator_of(robot))

    expected = kinds(core.events)
    ends = {"change.succeeded", "hold.released", "error.acknowledged", "task.canceled"}
    assert ends <= set(expected)
    assert kinds(robot.supervisor.events.oldest_first()) == expected
