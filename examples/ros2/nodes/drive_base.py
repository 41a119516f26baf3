"""The mobile base of the worked example: a lifecycle node with two parameters.

Pilothouse requests transitions of such a node and sets its parameters; the node decides what they
mean. This one only logs what a real base would do. Run it: `python3 drive_base.py`
"""

import rclpy
from heartbeat import offer_heartbeat
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

CONTROLLERS = ("PID", "MPC")


class DriveBase(LifecycleNode):
    """Drives at up to `max_speed`, in m/s, with one of two controllers."""

    def __init__(self) -> None:
        super().__init__("drive_base")
        # The values of __DEFAULT__ in the model. A parameter keeps its declared type.
        self.declare_parameter("max_speed", 0.1)
        self.declare_parameter("controller", "PID")
        self.add_on_set_parameters_callback(self._judge)
        self._heartbeat = offer_heartbeat(self)

    # Each transition calls one of these. SUCCESS: the transition completes. FAILURE: the node
    # returns to its previous state. ERROR, or an exception: on_error is called, and the node
    # becomes unconfigured or finalized.

    def on_configure(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Acquire resources: the motor bus, topics, memory."""
        self.get_logger().info("motors found")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Start working; the parameters of the mode are already set."""
        max_speed = self.get_parameter("max_speed").value
        self.get_logger().info(f"motors on, at most {max_speed} m/s")
        return super().on_activate(previous)

    def on_deactivate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Stop working, but stay ready to be activated again."""
        self.get_logger().info("motors off")
        return super().on_deactivate(previous)

    def on_cleanup(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Release resources."""
        self.get_logger().info("motors given back")
        return TransitionCallbackReturn.SUCCESS

    def _judge(self, parameters: list[Parameter]) -> SetParametersResult:
        """Accept all parameters or reject all; Pilothouse shows the reason."""
        for parameter in parameters:
            if parameter.name == "max_speed" and not parameter.value >= 0:
                return SetParametersResult(successful=False, reason="max_speed is negative")
            if parameter.name == "controller" and parameter.value not in CONTROLLERS:
                return SetParametersResult(successful=False, reason="controller is PID or MPC")
        return SetParametersResult(successful=True)


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = DriveBase()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
