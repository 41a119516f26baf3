"""Asks Pilothouse as any ROS 2 client may; nothing here knows of HTTP.

    python3 client.py get PART                 like `ros2 lifecycle get`, and the mode
    python3 client.py set SYSTEM TRANSITION    like `ros2 lifecycle set`
    python3 client.py mode PART MODE           like `ros2 service call /PART/change_mode ...`

Ends with 1 if what is asked is refused or fails.
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
REFUSED = "refused, or failed; why is in Pilothouse's log and its events"


def ask(node: Node, service: str, wanted: str = "") -> tuple[str, Any]:
    """Call a service; return its type and its response.

    Args:
        node: Who asks.
        service: As `/actuation/get_state`.
        wanted: The transition or the mode, where one is asked for.

    Raises:
        TimeoutError: There is no such service, or it does not answer.
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
        # A mode as well: where Pilothouse has no system_modes_msgs, it takes ROS 2's own type.
        request.transition.label = wanted
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=DONE_WITHIN_S)
    if not future.done():
        raise TimeoutError(f"{service} does not answer")
    return type_name, future.result()


def type_of(node: Node, service: str) -> str:
    """Return the type of a service, once somebody offers it."""
    end = time.monotonic() + THERE_WITHIN_S
    while time.monotonic() < end:
        types = dict(node.get_service_names_and_types()).get(service)
        if types:
            return types[0]
        time.sleep(0.05)
    raise TimeoutError(nobody_offers(service))


def nobody_offers(service: str) -> str:
    """Say that there is no such service, and where it was looked for."""
    domain = os.environ.get("ROS_DOMAIN_ID") or "0"
    return f"nobody offers {service} in domain {domain}; does Pilothouse run there, with ROS 2?"


def shown(node: Node, part: str) -> str:
    """Return state and mode of a part, as `active.SLOW`."""
    state = ask(node, f"/{part}/get_state")[1].current_state.label
    type_name, answer = ask(node, f"/{part}/get_mode")
    if type_name.startswith(NATIVE):
        mode = answer.current_mode
    else:
        mode = answer.current_state.label.partition(".")[2]
    return f"{state}.{mode}" if mode and state != "unknown" else state


def main() -> int:
    """Do what the command line says; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("action", choices=["get", "set", "mode"])
    parser.add_argument("part")
    parser.add_argument("wanted", nargs="?", help="a transition, or a mode")
    asked = parser.parse_args()
    if (asked.wanted is None) != (asked.action == "get"):
        parser.error("set and mode need to be told what is wanted, and get does not")
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
