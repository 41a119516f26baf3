"""Starts the two example nodes and Pilothouse, and starts a node again that ends.

    ros2 launch examples/ros2/pilothouse.launch.py
    ros2 launch examples/ros2/pilothouse.launch.py model:=mine.yaml robot:=mine_robot.yaml

If Pilothouse ends, launch ends all. A node is restarted by launch alone: a `process` entry in the
robot file would start a second one.
"""

from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, Shutdown
from launch.substitutions import LaunchConfiguration

HERE = Path(__file__).resolve().parent
MODEL = HERE.parents[1] / "service" / "example" / "actuation.yaml"
RESPAWN_DELAY_S = 1.0
STOPS_WITHIN_S = 15
"""Pilothouse stops the vehicle first, and waits until that stands."""


def generate_launch_description() -> LaunchDescription:
    """Return what is started; Pilothouse may come before or after the nodes."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("model", default_value=str(MODEL), description="Model file"),
            DeclareLaunchArgument(
                "robot", default_value=str(HERE / "robot.yaml"), description="Robot file"
            ),
            _node("drive_base"),
            _node("manipulator"),
            ExecuteProcess(
                cmd=[
                    "pilothouse",
                    "serve",
                    LaunchConfiguration("model"),
                    "--robot",
                    LaunchConfiguration("robot"),
                ],
                name="pilothouse",
                output="screen",
                sigterm_timeout=str(STOPS_WITHIN_S),
                on_exit=Shutdown(reason="Pilothouse has ended"),
            ),
        ]
    )


def _node(name: str) -> ExecuteProcess:
    """Return a node that is started again whenever it ends.

    For a node of a package, `launch_ros.actions.LifecycleNode` takes the same two arguments.
    """
    return ExecuteProcess(
        cmd=["python3", str(HERE / "nodes" / f"{name}.py")],
        name=name,
        output="screen",
        respawn=True,
        respawn_delay=RESPAWN_DELAY_S,
    )
