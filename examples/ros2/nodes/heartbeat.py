"""Lets others notice within a second that a process is gone, without a message ever sent."""

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

LEASE = Duration(seconds=0.5)


def offer_heartbeat(node: Node) -> Publisher:
    """Offer `~/heartbeat`; whoever watches its liveliness is told when this process is gone.

    The middleware says that the process lives, also while a callback runs for long: nothing has to
    be published. What is seen is the process: a callback that hangs for ever is not noticed here.

    Args:
        node: Whose heartbeat it is.

    Returns:
        A publisher to be kept as long as the node.
    """
    qos = QoSProfile(
        depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=LEASE
    )
    return node.create_publisher(Empty, "~/heartbeat", qos)
