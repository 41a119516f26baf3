"""What `tests/process/test_rosbridge_clients.py` tells, told by roslibpy; a program of its own.

Twisted, which is inside, has one reactor in a process, and it cannot be started twice.

    python -m tests.support.rosbridge_clients.story_of_roslibpy HOST:PORT TOKEN
"""

import json
import queue
import sys
from typing import Any

# It has no types.
import roslibpy  # type: ignore[import-untyped]

PATIENCE_S = 20


def tell(address: str, token: str) -> dict[str, Any]:
    """Use a service as its users do, and return what it said."""
    ros = roslibpy.Ros(f"ws://{address}/rosbridge", headers={"Authorization": f"Bearer {token}"})
    statuses: queue.Queue[Any] = queue.Queue()
    # It has no way of its own to hear a status.
    ros.factory.on_ready(lambda wire: wire._message_handlers.update(status=statuses.put))  # noqa: SLF001
    ros.run(PATIENCE_S)
    states, events = _subscribe(ros, "/system_state"), _subscribe(ros, "/actuation/mode_event")
    told = {
        "topics": ros.get_topics(),
        "time": ros.get_time().to_sec(),
        "states": [states.get(timeout=PATIENCE_S) for _ in range(40)],
        "changed": _call(ros, {"mode_name": "PERFORMANCE"}),
    }
    told["event"] = _wait(events, lambda event: event["goal_mode"]["label"] == "PERFORMANCE")
    told["failed"] = _call(ros, {"mode_name": 7})
    ros.send_on_ready(roslibpy.Message({"op": "no_such_op", "id": "bad"}))
    told["status"] = dict(statuses.get(timeout=PATIENCE_S))
    estop = roslibpy.Topic(ros, "/estop", "gem_state_msgs/EstopStamped")
    estop.publish(roslibpy.Message({"enabled": True}))
    told["stopped"] = _wait(states, lambda state: state["state"] == 2)
    ros.terminate()
    return told


def _subscribe(ros: Any, topic: str) -> "queue.Queue[Any]":  # noqa: ANN401
    heard: queue.Queue[Any] = queue.Queue()
    roslibpy.Topic(ros, topic, "").subscribe(heard.put)
    return heard


def _call(ros: Any, request: dict[str, object]) -> dict[str, Any]:  # noqa: ANN401
    service = roslibpy.Service(ros, "/actuation/change_mode", "system_modes_msgs/ChangeMode")
    try:
        return dict(service.call(roslibpy.ServiceRequest(request), timeout=PATIENCE_S))
    except roslibpy.core.ServiceException as error:
        return {"error": str(error)}


def _wait(heard: "queue.Queue[Any]", is_it: Any) -> Any:  # noqa: ANN401
    while not is_it(found := heard.get(timeout=PATIENCE_S)):
        pass
    return found


if __name__ == "__main__":
    print(json.dumps(tell(*sys.argv[1:])))
