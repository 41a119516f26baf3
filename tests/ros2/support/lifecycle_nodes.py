"""Real lifecycle nodes of rclpy, some in one process, to be silenced and killed by tests.

python lifecycle_nodes.py NODES, with NODES as JSON: a list of objects with a `name` and, where
wanted, `parameters` (values by name), `heartbeat` (true) and `lifecycle` (false: a plain node).
Prints `ready` once all are there.
"""

import json
import signal
import sys
from typing import Any

import rclpy
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Empty

HEARTBEAT = QoSProfile(
    depth=1,
    liveliness=LivelinessPolicy.AUTOMATIC,
    liveliness_lease_duration=Duration(seconds=0.5),
)


def made(spec: dict[str, Any]) -> Any:  # noqa: ANN401  # rclpy's
    """Return a node as it is described."""
    namespace, _, name = spec["name"].rpartition("/")
    kind = LifecycleNode if spec.get("lifecycle", True) else Node
    node = kind(name, namespace=f"/{namespace}")
    for parameter, value in spec.get("parameters", {}).items():
        node.declare_parameter(parameter, value)
    if spec.get("heartbeat", False):
        # Nothing is published on it: the middleware of this process says that it lives.
        node.create_publisher(Empty, "~/heartbeat", HEARTBEAT)
    return node


def main() -> None:
    """Run all nodes in one executor until SIGTERM."""
    # At once, since there is nothing here to be saved.
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    executor = SingleThreadedExecutor()
    for spec in json.loads(sys.argv[1]):
        executor.add_node(made(spec))
    print("ready", flush=True)
    executor.spin()


if __name__ == "__main__":
    main()
