"""The arm of the worked example: a lifecycle node with one parameter.

`drive_base.py` explains what both nodes share. Run it: `python3 manipulator.py`
"""

import rclpy
from heartbeat import offer_heartbeat
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter


class Manipulator(LifecycleNode):
    """Grips with at most `max_torque`, in Nm."""

    def __init__(self) -> None:
        super().__init__("manipulator")
        self.declare_parameter("max_torque", 0.1)
        self.add_on_set_parameters_callback(self._judge)
        self._heartbeat = offer_heartbeat(self)

    def on_configure(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Find the arm."""
        self.get_logger().info("arm found")
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Release the brakes."""
        max_torque = self.get_parameter("max_torque").value
        self.get_logger().info(f"brakes off, at most {max_torque} Nm")
        return super().on_activate(previous)

    def on_deactivate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Apply the brakes."""
        self.get_logger().info("brakes on")
        return super().on_deactivate(previous)

    def on_cleanup(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Release the arm."""
        self.get_logger().info("arm given back")
        return TransitionCallbackReturn.SUCCESS

    def _judge(self, parameters: list[Parameter]) -> SetParametersResult:
        """Accept all parameters or reject all."""
        for parameter in parameters:
            if parameter.name == "max_torque" and not parameter.value >= 0:
                return SetParametersResult(successful=False, reason="max_torque is negative")
        return SetParametersResult(successful=True)


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = Manipulator()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
