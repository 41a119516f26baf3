"""An emergency stop button in ROS 2: `/estop`, a `std_msgs/msg/Bool`.

For each line on standard input, `press` or `release`, it publishes once and prints the monotonic
time just before that, in ns. Prints `ready` at the start.
"""

import sys
import time

import rclpy
from std_msgs.msg import Bool


def main() -> None:
    """Publish until standard input ends."""
    rclpy.init()
    publisher = rclpy.create_node("estop_button").create_publisher(Bool, "/estop", 1)
    print("ready", flush=True)
    for line in sys.stdin:
        message = Bool(data=line.strip() == "press")
        at = time.monotonic_ns()
        publisher.publish(message)
        print(at, flush=True)


if __name__ == "__main__":
    main()
