"""`pilothouse tracker`: drive a vehicle in ROS 2 along the waypoints of an action's goals."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command

COMMAND_TYPES = (
    "geometry_msgs/msg/Twist",
    "geometry_msgs/msg/TwistStamped",
    "ackermann_msgs/msg/AckermannDrive",
    "ackermann_msgs/msg/AckermannDriveStamped",
)

_TEXT = """\
Drive a vehicle in ROS 2 along waypoints until Ctrl-C or SIGTERM: an action
server of type pilothouse_msgs/action/NavigateWaypoints, for `navigation` of the
robot file, or for any other client. The trackers are those of the service.

A newer goal replaces the one before. A goal that is canceled ends when the
vehicle stands. Without odometry, too far from the path, without progress or
with commands that do not arrive, a goal is aborted, and the result says why.
Speed 0 is commanded before any of that is told, and when this process ends.

It supervises nothing: no signals, no emergency stop. Who sends the goals does,
such as: pilothouse serve MODEL --backend ros2 --robot FILE
Once it has heard /system_state, a silence of 1 s (`navigation.silent_for_s` of
the robot file) aborts the goal: nobody else would stop the vehicle.

Source setup.bash of the ROS 2 distribution first, and the workspace that has
pilothouse_msgs (examples/ros2).

examples:
  pilothouse tracker
  pilothouse tracker --tracker stanley --odometry /gem/odometry \\
      --command /gem/drive --command-type ackermann_msgs/msg/AckermannDrive
  pilothouse tracker model.yaml --robot robot.yaml

exit code: 0 ended by a signal; 1 failed, or a file or a type is invalid;
           2 there is no ROS 2, or a file cannot be read;
           64 invalid options;
           130 ended by a second Ctrl-C
"""


def _topic(name: str) -> str:
    """Read the full name of a topic or an action.

    Raises:
        ArgumentTypeError: It is none.
    """
    from service.files.ros2_block import topic_name

    try:
        return topic_name(name)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "model",
        nargs="?",
        type=Path,
        metavar="MODEL",
        help="model file that the robot file belongs to; default: an example",
    )
    parser.add_argument(
        "--tracker",
        choices=("pure_pursuit", "stanley"),
        default="pure_pursuit",
        help="default: %(default)s",
    )
    parser.add_argument(
        "--action",
        type=_topic,
        default="/navigate_waypoints",
        metavar="NAME",
        help="full name of the action; default: %(default)s",
    )
    parser.add_argument(
        "--robot",
        type=Path,
        metavar="FILE",
        help="robot file: `vehicle`, `driving`, and odometry and command of `ros2`",
    )
    parser.add_argument(
        "--odometry",
        type=_topic,
        metavar="TOPIC",
        help="nav_msgs/msg/Odometry of the vehicle; default: as in the robot file, else /odom",
    )
    parser.add_argument(
        "--command",
        type=_topic,
        metavar="TOPIC",
        help="drive commands to the vehicle; default: as in the robot file, else /cmd_vel",
    )
    parser.add_argument(
        "--command-type",
        choices=COMMAND_TYPES,
        metavar="TYPE",
        help=f"one of {', '.join(COMMAND_TYPES)}; default: as in the robot file, else the first",
    )
    parser.add_argument(
        "--log-level", default="info", choices=("debug", "info", "warning", "error")
    )


def _run(options: argparse.Namespace) -> int:
    from api.serving.tracking import TrackerOptions, track

    return track(
        TrackerOptions(
            options.tracker,
            options.action,
            options.model,
            options.robot,
            options.odometry,
            options.command,
            options.command_type,
            options.log_level,
        )
    )


COMMAND = Command("tracker", "drive a vehicle in ROS 2 along waypoints", _TEXT, _add_options, _run)
