import sys
from types import SimpleNamespace

import pytest

from api.serving.joining import join_graph
from api.serving.misuse import MisuseError
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph

LINK = "service.ros.graph.link"


def test_the_graph_is_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = FakeGraph(ManualClock())
    monkeypatch.setitem(sys.modules, LINK, SimpleNamespace(RosLink=lambda: graph))

    assert join_graph() is graph


def test_without_rclpy_it_is_said_where_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, LINK, None)

    with pytest.raises(MisuseError, match=r"pip install 'pilothouse\[ros2\]'"):
        join_graph()


def test_middleware_that_does_not_start_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> FakeGraph:
        raise RuntimeError("no shared memory")

    monkeypatch.setitem(sys.modules, LINK, SimpleNamespace(RosLink=fail))

    with pytest.raises(MisuseError, match="ROS 2 does not start: no shared memory"):
        join_graph()
