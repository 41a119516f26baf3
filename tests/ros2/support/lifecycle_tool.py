"""What `ros2 lifecycle` does, call by call, in a process of its own: the tool is not in the wheels.

python lifecycle_tool.py nodes
python lifecycle_tool.py get NODE
python lifecycle_tool.py list NODE
python lifecycle_tool.py set NODE TRANSITION

Prints what the tool prints. Waits for up to 10 s until NODE is found, as its daemon would know it.
"""

import sys
import time
from typing import Any

import rclpy
from lifecycle_msgs.srv import (
    ChangeState,
    GetAvailableTransitions,
    GetState,
)

PATIENCE_S = 10.0


def lifecycle_nodes(node: Any) -> list[str]:  # noqa: ANN401  # rclpy's
    """Return the nodes that have a service `get_state` of the lifecycle's type."""
    services = dict(node.get_service_names_and_types())
    names = [
        f"{namespace.rstrip('/')}/{name}"
        for name, namespace in node.get_node_names_and_namespaces()
    ]
    wanted = "lifecycle_msgs/srv/GetState"
    return [name for name in names if wanted in services.get(f"{name}/get_state", ())]


def find(node: Any, name: str) -> bool:  # noqa: ANN401  # rclpy's
    """Tell whether a lifecycle node is there, or appears soon."""
    until = time.monotonic() + PATIENCE_S
    while name not in lifecycle_nodes(node):
        if time.monotonic() > until:
            return False
        rclpy.spin_once(node, timeout_sec=0.1)
    return True


def call(node: Any, kind: Any, service: str, request: Any = None) -> Any:  # noqa: ANN401  # rclpy's
    """Call a service and return its response."""
    client = node.create_client(kind, service)
    while not client.service_is_ready():
        rclpy.spin_once(node, timeout_sec=1.0)
    response = client.call_async(request or kind.Request())
    rclpy.spin_until_future_complete(node, response, timeout_sec=60.0)
    return response.result()


def transitions(node: Any, name: str) -> list[Any]:  # noqa: ANN401  # rclpy's
    """Return what the node says can be done."""
    response = call(node, GetAvailableTransitions, f"{name}/get_available_transitions")
    return list(response.available_transitions)


def show_transitions(node: Any, name: str) -> None:  # noqa: ANN401  # rclpy's
    """Print the transitions that begin in the state that the node is in."""
    state = call(node, GetState, f"{name}/get_state").current_state
    for each in transitions(node, name):
        if each.start_state == state:
            print(f"- {each.transition.label} [{each.transition.id}]")
            print(f"\tStart: {each.start_state.label}")
            print(f"\tGoal: {each.goal_state.label}")


def set_state(node: Any, name: str, wanted: str) -> None:  # noqa: ANN401  # rclpy's
    """Look the transition up among the available ones, and ask for it by number and label."""
    found = [each.transition for each in transitions(node, name)]
    request = ChangeState.Request()
    for transition in found:
        if wanted in (transition.label, str(transition.id)):
            request.transition = transition
            break
    else:
        print("Unknown transition requested, available ones are:")
        print("".join(f"- {each.label} [{each.id}]\n" for each in found), end="")
        return
    done = call(node, ChangeState, f"{name}/change_state", request).success
    print("Transitioning successful" if done else "Transitioning failed")


def main() -> None:
    """Do what the arguments say."""
    verb, *names = sys.argv[1:]
    rclpy.init()
    node = rclpy.create_node("lifecycle_tool")
    if names and not find(node, names[0]):
        print("Node not found")
    elif verb == "get":
        state = call(node, GetState, f"{names[0]}/get_state").current_state
        print(f"{state.label} [{state.id}]")
    elif verb == "list":
        show_transitions(node, names[0])
    elif verb == "set":
        set_state(node, *names)
    rclpy.shutdown()


main()
