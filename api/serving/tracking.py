"""`pilothouse tracker`: runs an action server that drives a vehicle in ROS 2 along waypoints."""

import asyncio
import logging
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from api.serving.failures import (
    FAILED,
    MISUSED,
    SUCCEEDED,
    complain_of,
    end_with,
    leaves,
    tell_failure,
)
from api.serving.joining import join_graph
from api.serving.misuse import MisuseError
from api.serving.output import Output
from api.serving.process_log import log_to
from api.serving.stop_signals import StopSignals
from api.terminal_text import say
from domain.errors import InvalidModelError
from domain.timebase import seconds
from service.clock import MonotonicClock
from service.files.model_file import EXAMPLE, load_model
from service.files.robot_file import InvalidRobotFileError, RobotSettings, read_robot_file
from service.files.ros2_block import CommandBlock, CommandType, OdometryBlock, Ros2Block
from service.files.text_file import UnreadableFileError, read_text_file
from service.ros.graph.graph import RosGraph, UnknownTypeError
from service.ros.tracker_node import TrackerNode, TrackerSettings

ODOMETRY, COMMAND = "/odom", "/cmd_vel"
COMMAND_TYPE: CommandType = "geometry_msgs/msg/Twist"
_STDERR = 2
_SUPERVISED_WITHIN = seconds(1.0)
"""Pilothouse publishes its state at 20 Hz."""


@dataclass(frozen=True, slots=True)
class TrackerOptions:
    """The options of `pilothouse tracker`; None: as in the robot file, or the usual topic."""

    controller: str
    action: str
    model: Path | None = None
    """Model file that the robot file belongs to; None: the example."""
    robot: Path | None = None
    odometry: str | None = None
    command: str | None = None
    command_type: CommandType | None = None
    log_level: str = "info"


def track(options: TrackerOptions) -> int:
    """Run the action server until a signal ends it, and return the exit code of the process."""
    errors = Output(_STDERR)
    try:
        log_to(errors, options.log_level, None)
        settings = settings_of(options)
        graph = join_graph()
        for line in _greeting(settings):
            say(line)
        return asyncio.run(_run(TrackerNode(settings, graph, MonotonicClock()), graph))
    except (MisuseError, UnreadableFileError) as error:
        return end_with(str(error), MISUSED)
    except InvalidModelError as error:
        return complain_of(options.model or EXAMPLE, error.findings)
    except InvalidRobotFileError as error:
        return complain_of(options.robot, error.findings)
    finally:
        logging.shutdown()
        errors.close()


def settings_of(options: TrackerOptions) -> TrackerSettings:
    """Return what is driven, and how.

    Raises:
        UnreadableFileError: A file cannot be read.
        InvalidModelError: The model is invalid.
        InvalidRobotFileError: The robot file is invalid.
    """
    robot = _robot_of(options)
    odometry, command = robot.ros2.odometry, robot.ros2.command
    if options.odometry is not None or odometry is None:
        odometry = OdometryBlock(topic=options.odometry or ODOMETRY)
    topic, kind = COMMAND, COMMAND_TYPE
    if command is not None:
        topic, kind = command.topic, command.type
    command = CommandBlock(
        topic=options.command or topic,
        type=options.command_type or kind,
    )
    asked = robot.ros2.navigation
    return TrackerSettings(
        options.action,
        options.controller,
        Ros2Block(odometry=odometry, command=command),
        robot.to_vehicle_limits(),
        robot.to_task_settings(),
        robot.to_navigation_settings(),
        _SUPERVISED_WITHIN if asked is None else seconds(asked.silent_for_s),
    )


def _robot_of(options: TrackerOptions) -> RobotSettings:
    if options.robot is None:
        return RobotSettings()
    loaded = load_model(options.model or EXAMPLE)
    return read_robot_file(read_text_file(options.robot), loaded.model)


def _greeting(settings: TrackerSettings) -> Iterator[str]:
    odometry, command = settings.topics.odometry, settings.topics.command
    assert odometry is not None
    assert command is not None
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    name = f"{settings.controller} drives the goals of {settings.action}"
    yield f"{name} (ROS 2 domain {domain})"
    yield f"  odometry  {odometry.topic}"
    yield f"  commands  {command.topic}  {command.type}"
    yield "It supervises nothing. Ctrl-C stops the vehicle."


async def _run(node: TrackerNode, graph: RosGraph) -> int:
    """Run until a signal or a failure, and return the exit code of the process."""
    stopping = asyncio.Event()
    StopSignals(stopping.set).install()
    code = SUCCEEDED
    try:
        async with asyncio.TaskGroup() as tasks:
            watching = tasks.create_task(graph.wait_failed(), name="ROS 2")
            await node.run(stopping)
            watching.cancel()
    except* UnknownTypeError as failures:
        for failure in leaves(failures):
            end_with(str(failure), FAILED)
        code = FAILED
    except* Exception as failures:
        for failure in leaves(failures):
            tell_failure(failure)
        code = FAILED
    finally:
        await graph.close()
    return code
