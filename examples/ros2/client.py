"""Calls Pilothouse like any ROS 2 client, without HTTP.

    python3 client.py get PART                 like `ros2 lifecycle get`, plus the mode
    python3 client.py set SYSTEM TRANSITION    like `ros2 lifecycle set`
    python3 client.py mode PART MODE           like `ros2 service call /PART/change_mode ...`

Exits with 1 if the request is rejected or fails.
"""

import argparse
import importlib
import os
import sys
import time
from typing import Any

import rclpy
from rclpy.node import Node

THERE_WITHIN_S = 10.0
DONE_WITHIN_S = 70.0
NATIVE = "system_modes_msgs/srv/"
REFUSED = "rejected or failed; see Pilothouse's log and events"


def ask(node: Node, service: str, wanted: str = "") -> tuple[str, Any]:
    """Call a service; return its type and its response.

    Args:
        node: The client node.
        service: Its full name, such as `/actuation/get_state`.
        wanted: The requested transition or mode; empty for queries.

    Raises:
        TimeoutError: The service does not exist or does not answer.
    """
    type_name = type_of(node, service)
    package, kind, name = type_name.split("/")
    service_type = getattr(importlib.import_module(f"{package}.{kind}"), name)
    client = node.create_client(service_type, service)
    if not client.wait_for_service(THERE_WITHIN_S):
        raise TimeoutError(nobody_offers(service))
    request = service_type.Request()
    if hasattr(request, "mode_name"):
        request.mode_name = wanted
    elif hasattr(request, "transition"):
        # Also for a mode: without system_modes_msgs, Pilothouse uses a standard ROS 2 type.
        request.transition.label = wanted
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=DONE_WITHIN_S)
    if not future.done():
        raise TimeoutError(f"{service} does not answer")
    return type_name, future.result()


def type_of(node: Node, service: str) -> str:
    """Return the type of a service as soon as it exists."""
    end = time.monotonic() + THERE_WITHIN_S
    while time.monotonic() < end:
        types: list[str] = dict(node.get_service_names_and_types()).get(service, [])
        if types:
            return types[0]
        time.sleep(0.05)
    raise TimeoutError(nobody_offers(service))


def nobody_offers(service: str) -> str:
    """Return a message that names the missing service and the searched domain."""
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    return f"nobody offers {service} in domain {domain}; does Pilothouse run there, with ROS 2?"


def shown(node: Node, part: str) -> str:
    """Return state and mode of a part, such as `active.SLOW`."""
    state = ask(node, f"/{part}/get_state")[1].current_state.label
    type_name, answer = ask(node, f"/{part}/get_mode")
    if type_name.startswith(NATIVE):
        mode = answer.current_mode
    else:
        mode = answer.current_state.label.partition(".")[2]
    return f"{state}.{mode}" if mode and state != "unknown" else state


def main() -> int:
    """Run the command line; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("action", choices=["get", "set", "mode"])
    parser.add_argument("part")
    parser.add_argument("wanted", nargs="?", help="a transition, or a mode")
    asked = parser.parse_args()
    if (asked.wanted is None) != (asked.action == "get"):
        parser.error("set and mode need a transition or mode, and get takes none")
    rclpy.init()
    node = rclpy.create_node("client")
    success = True
    try:
        if asked.action != "get":
            service = "change_state" if asked.action == "set" else "change_mode"
            success = ask(node, f"/{asked.part}/{service}", asked.wanted)[1].success
        print(f"{asked.part}: {shown(node, asked.part) if success else REFUSED}")
    except TimeoutError as error:
        print(error, file=sys.stderr)
        success = False
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0 if success else 1


if __name__ == "__main__":
    sys.exit(main())
