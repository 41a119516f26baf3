import asyncio
import logging

import pytest

from domain.inputs import EmergencyStopRequest, ModeRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.simulation.node_settings import Fault
from service.ros.interface.change_calls import carry_out
from tests.support.manual_clock import settle
from tests.support.models import ACTUATION, ARM, BASE
from tests.support.ros_robot import OPERATOR, RosRobot


async def test_a_request_is_a_success_once_every_node_is_there(robot: RosRobot) -> None:
    asked = asyncio.create_task(
        carry_out(robot.supervisor, ModeRequest(ACTUATION, "PERFORMANCE", OPERATOR))
    )
    await robot.clock.advance(0.3)
    assert not asked.done()

    await robot.clock.advance(1.0)

    assert await asked is True
    actual = robot.supervisor.core.part(ACTUATION).actual
    assert actual.state_and_mode.label == "active.PERFORMANCE"


async def test_a_request_that_is_met_already_is_a_success_at_once(robot: RosRobot) -> None:
    await robot.change_mode("drive_base", "FAST")

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "FAST", OPERATOR)) is True


async def test_a_refusal_is_no_success_and_its_reason_is_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    robot.supervisor.submit(EmergencyStopRequest(engaged=True, reason="fire"))

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "FAST", OPERATOR)) is False

    assert "'FAST' of drive_base, asked by test:operator" in caplog.text
    assert "emergency stop is engaged" in caplog.text


async def test_a_mode_that_does_not_exist_is_refused(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)

    assert await carry_out(robot.supervisor, ModeRequest(BASE, "WARP", OPERATOR)) is False
    assert "there is no mode of drive_base 'WARP'" in caplog.text


async def test_a_change_that_fails_is_no_success_and_its_reason_is_logged(
    robot: RosRobot, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    robot.fault("manipulator", Fault.FAIL)
    request = TransitionRequest(ARM, Transition.ACTIVATE, OPERATOR)
    asked = asyncio.create_task(carry_out(robot.supervisor, request))

    await robot.clock.advance(2.0)

    assert await asked is False
    assert "failed: manipulator" in caplog.text


async def test_a_change_that_runs_on_after_a_minute_is_no_success(
    robot: RosRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.ros.interface.change_calls.MAX_WAIT_S", 5.0)
    robot.fault("manipulator", Fault.SILENT)
    request = TransitionRequest(ARM, Transition.ACTIVATE, OPERATOR)
    asked = asyncio.create_task(carry_out(robot.supervisor, request))

    await robot.clock.advance(4.9)
    assert not asked.done()
    await robot.clock.advance(0.2)
    await settle()

    assert await asked is False
