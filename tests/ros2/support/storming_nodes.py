"""Real lifecycle nodes that report parameters as fast as their process can.

python storming_nodes.py NODES ROUNDS, with NODES as of `lifecycle_nodes.py` and ROUNDS as JSON: a
list of parameters (values by name) that each node reports in turn. Prints `ready` once all nodes
are there. A line on standard input begins the storm; SIGKILL ends it.
"""

import json
import os
import sys
import threading
import time
from itertools import cycle
from typing import Any

import rclpy
from lifecycle_nodes import made  # type: ignore[import-not-found]  # beside this file
from rcl_interfaces.msg import ParameterEvent
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_parameter_events

PAUSE_S = 0.0


def events(name: str, rounds: list[dict[str, Any]]) -> list[Any]:
    """Return the messages of one node, one for each round."""
    return [
        ParameterEvent(
            node=f"/{name}",
            changed_parameters=[
                Parameter(parameter, value=value).to_parameter_msg()
                for parameter, value in values.items()
            ],
        )
        for values in rounds
    ]


def main() -> None:
    """Run all nodes in one executor, and storm from another thread while that is wanted."""
    # What is measured is a queue, and not who gets a core.
    os.nice(19)
    specs, rounds = json.loads(sys.argv[1]), json.loads(sys.argv[2])
    rclpy.init()
    executor = SingleThreadedExecutor()
    for spec in specs:
        executor.add_node(made(spec))
    threading.Thread(target=executor.spin, daemon=True).start()
    sender = rclpy.create_node(f"storm_of_{specs[0]['name'].replace('/', '_')}")
    publisher = sender.create_publisher(
        ParameterEvent, "/parameter_events", qos_profile_parameter_events
    )
    by_round = list(zip(*(events(spec["name"], rounds) for spec in specs), strict=True))
    print("ready", flush=True)
    sys.stdin.readline()
    for messages in cycle(by_round):
        for message in messages:
            publisher.publish(message)
        # Its own executor has to answer as well.
        time.sleep(PAUSE_S)


if __name__ == "__main__":
    main()
