import sys
from types import SimpleNamespace

import pytest

from api.serving.misuse import MisuseError
from api.serving.ros_graph import join_graph

LINK = "service.ros.graph.link"


@pytest.mark.parametrize("absent", ["rclpy", LINK])
def test_without_rclpy_it_is_said_what_to_do(absent: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, LINK, raising=False)
    monkeypatch.setitem(sys.modules, absent, None)

    with pytest.raises(MisuseError) as caught:
        join_graph()

    for way in ("source the setup.bash", "pip install 'pilothouse[ros2]'"):
        assert way in str(caught.value)


def test_a_middleware_that_does_not_start_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def start() -> None:
        raise RuntimeError("ROS_DOMAIN_ID is not an integral number")

    monkeypatch.setitem(sys.modules, LINK, SimpleNamespace(RosLink=start))

    with pytest.raises(MisuseError, match="ROS 2 does not start: ROS_DOMAIN_ID is"):
        join_graph()


def test_with_rclpy_it_is_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = object()
    monkeypatch.setitem(sys.modules, LINK, SimpleNamespace(RosLink=lambda: graph))

    assert join_graph() is graph
