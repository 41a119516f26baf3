"""Calls Pilothouse like any ROS 2 client, without HTTP.

    python3 client.py get PART                 like `ros2 lifecycle get`, plus the mode
    python3 client.py set SYSTEM TRANSITION    like `ros2 lifecycle set`
    python3 client.py mode PART MODE           like `ros2 service call /PART/change_mode ...`
    python3 client.py param NODE NAME VALUE    like `ros2 param set`

Exits with 1 if the request is rejected or fails.
"""

import argparse
import importlib
import os
import sys
import time
from typing import Any

import rclpy
from rcl_interfaces.msg import Parameter
from rcl_interfaces.srv import SetParameters
from rclpy.node import Node
from rclpy.parameter import get_parameter_value

THERE_WITHIN_S = 10.0
DONE_WITHIN_S = 70.0
NATIVE = "system_modes_msgs/srv/"
WANTED = {"get": (), "set": ("TRANSITION",), "mode": ("MODE",), "param": ("NAME", "VALUE")}
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
    request = service_type.Request()
    if hasattr(request, "mode_name"):
        request.mode_name = wanted
    elif hasattr(request, "transition"):
        # Also for a mode: without system_modes_msgs, Pilothouse uses a standard ROS 2 type.
        request.transition.label = wanted
    return type_name, call(node, service, service_type, request)


def call(node: Node, service: str, service_type: Any, request: Any) -> Any:  # noqa: ANN401
    """Call a service and return its response.

    Raises:
        TimeoutError: The service does not exist or does not answer.
    """
    client = node.create_client(service_type, service)
    if not client.wait_for_service(THERE_WITHIN_S):
        raise TimeoutError(nobody_offers(service))
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=DONE_WITHIN_S)
    if not future.done():
        raise TimeoutError(f"{service} does not answer")
    return future.result()


def set_parameter(node: Node, name: str, parameter: str, value: str) -> str:
    """Set a parameter of a node; return what came of it.

    Args:
        node: The client node.
        name: Name of the node.
        parameter: Name of the parameter.
        value: As in YAML: `0.1` is a double, `1` an integer.

    Raises:
        TimeoutError: There is no such node, or it does not answer.
    """
    wanted = Parameter(name=parameter, value=get_parameter_value(value))
    request = SetParameters.Request(parameters=[wanted])
    result = call(node, f"/{name}/set_parameters", SetParameters, request).results[0]
    return "" if result.successful else result.reason or "refused"


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
    parser.add_argument("action", choices=list(WANTED))
    parser.add_argument("part")
    parser.add_argument("wanted", nargs="*", help="a transition, a mode, or name and value")
    asked = parser.parse_args()
    if len(asked.wanted) != len(WANTED[asked.action]):
        parser.error(" ".join((asked.action, "PART", *WANTED[asked.action])) + " is what it takes")
    rclpy.init()
    node = rclpy.create_node("client")
    try:
        told, success = done(node, asked.action, asked.part, asked.wanted)
        print(f"{asked.part}: {told}")
    except TimeoutError as error:
        print(error, file=sys.stderr)
        success = False
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0 if success else 1


def done(node: Node, action: str, part: str, wanted: list[str]) -> tuple[str, bool]:
    """Do what was asked; return what came of it, and whether it succeeded."""
    if action == "param":
        refused = set_parameter(node, part, *wanted)
        return refused or " = ".join(wanted), not refused
    if action != "get":
        service = "change_state" if action == "set" else "change_mode"
        if not ask(node, f"/{part}/{service}", *wanted)[1].success:
            return REFUSED, False
    return shown(node, part), True


if __name__ == "__main__":
    sys.exit(main())
