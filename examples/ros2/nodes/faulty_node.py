"""A lifecycle node that is slow, refuses or dies, by its parameters, to see what follows from that.

Give it the name of a node of your model, and the parameters that its modes set:

    python3 faulty_node.py --ros-args -r __node:=manipulator -p max_torque:=0.1 -p slow:=3.0

Each parameter may be changed while it runs, as by `ros2 param set /manipulator refuse activate`.
"""

import os
import time

import rclpy
from heartbeat import offer_heartbeat
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn

DIED = 1


class FaultyNode(LifecycleNode):
    """Does what its faults leave of a transition.

    `refuse`, `fail` and `die` name one of the transitions configure, activate, deactivate and
    cleanup; empty: none.
    """

    def __init__(self) -> None:
        # Whatever else a mode sets is declared by `-p NAME:=VALUE`.
        super().__init__("faulty_node", automatically_declare_parameters_from_overrides=True)
        # In s: how long each transition takes; the node answers nothing meanwhile.
        self._declare("slow", 0.0)
        # The transition is not done, and the node stays in its state.
        self._declare("refuse", "")
        # The transition raises an exception, and the node becomes unconfigured.
        self._declare("fail", "")
        # The process ends in the transition, as by `kill -9`.
        self._declare("die", "")
        self._heartbeat = offer_heartbeat(self)

    def _declare(self, name: str, value: float | str) -> None:
        if not self.has_parameter(name):
            self.declare_parameter(name, value)

    def on_configure(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Acquire nothing."""
        return self._do("configure")

    def on_activate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Begin to do nothing."""
        done = self._do("activate")
        return super().on_activate(previous) if done is TransitionCallbackReturn.SUCCESS else done

    def on_deactivate(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Stop doing nothing."""
        done = self._do("deactivate")
        return super().on_deactivate(previous) if done is TransitionCallbackReturn.SUCCESS else done

    def on_cleanup(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Release nothing."""
        return self._do("cleanup")

    def on_error(self, previous: LifecycleState) -> TransitionCallbackReturn:
        """Become unconfigured."""
        return TransitionCallbackReturn.SUCCESS

    def _do(self, transition: str) -> TransitionCallbackReturn:
        time.sleep(self.get_parameter("slow").value)
        if self._is("die", transition):
            os._exit(DIED)
        if self._is("fail", transition):
            raise RuntimeError(f"{transition} fails, as it was told to")
        if self._is("refuse", transition):
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def _is(self, fault: str, transition: str) -> bool:
        return bool(self.get_parameter(fault).value == transition)


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = FaultyNode()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
