"""Lets others detect within a second that a process is gone, without sending any message."""

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import LivelinessPolicy, QoSProfile
from std_msgs.msg import Empty

LEASE = Duration(seconds=0.5)


def offer_heartbeat(node: Node) -> Publisher:
    """Offer `~/heartbeat`; subscribers to its liveliness are told when this process is gone.

    The middleware asserts the liveliness of the process, even during a long callback, so nothing
    has to be published. It only covers the process: a callback that hangs is not detected.

    Args:
        node: The node that gets the heartbeat.

    Returns:
        A publisher; keep it as long as the node.
    """
    qos = QoSProfile(
        depth=1, liveliness=LivelinessPolicy.AUTOMATIC, liveliness_lease_duration=LEASE
    )
    return node.create_publisher(Empty, "~/heartbeat", qos)
