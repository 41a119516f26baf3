"""A camera in a process of its own: publishes images of a given size at a given rate."""

import sys
import time
from array import array
from importlib import import_module

rclpy = import_module("rclpy")
Image = import_module("sensor_msgs.msg").Image

TOPIC = "/image"


def main(rate_hz: float, size: int) -> None:
    """Publish until killed; each image has the time at which it was sent."""
    rclpy.init()
    node = rclpy.create_node("camera")
    publisher = node.create_publisher(Image, TOPIC, 5)
    image = Image(height=1, width=size, encoding="mono8", step=size)
    image.data = array("B", bytes(size))
    print("ready", flush=True)
    due = time.monotonic()
    while True:
        due += 1 / rate_hz
        time.sleep(max(0.0, due - time.monotonic()))
        image.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(image)


if __name__ == "__main__":
    main(float(sys.argv[1]), int(sys.argv[2]))
