"""What is wrong in a graph, as a node of rclpy describes it."""

from types import SimpleNamespace
from typing import Any

from domain.graph_terms import GraphFault, GraphFaultKind
from service.ros.graph.survey import TOPICS_AT_ONCE, End, Survey

IMAGE, SCAN = "sensor_msgs/msg/Image", "sensor_msgs/msg/LaserScan"


class Graph:
    """The part of a node of rclpy that knows the graph."""

    def __init__(self) -> None:
        self.names = [("pilothouse", "/")]
        self.publishers: dict[str, list[Any]] = {}
        self.subscriptions: dict[str, list[Any]] = {}
        self.asked: list[str] = []

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        return self.names

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        self.asked.append(topic)
        return self.publishers.get(topic, [])

    def get_subscriptions_info_by_topic(self, topic: str) -> list[Any]:
        self.asked.append(topic)
        return self.subscriptions.get(topic, [])


def end(node: str, type_name: str, profile: str) -> Any:  # noqa: ANN401  # as rclpy has it
    """Return an end of a topic in another process."""
    return SimpleNamespace(
        node_name=node, node_namespace="/", topic_type=type_name, qos_profile=profile
    )


def judge(offered: str, requested: str) -> str:
    """Best effort does not satisfy reliable."""
    return "too little" if (offered, requested) == ("best effort", "reliable") else ""


def survey(*ends: End) -> Survey:
    """Return a survey of some ends."""
    made = Survey(judge)
    for each in ends:
        made.add(each)
    return made


def test_a_publisher_that_offers_too_little_is_found_and_forgotten_when_it_is_gone() -> None:
    graph, looking = Graph(), survey(End("/scan", SCAN, "reliable", publishes=False))
    graph.publishers["/scan"] = [end("lidar", SCAN, "best effort")]

    assert looking.look(graph) == (
        GraphFault(GraphFaultKind.QOS, "/scan", "no message arrives from /lidar: too little"),
    )

    graph.publishers["/scan"] = [end("lidar", SCAN, "reliable")]
    assert looking.look(graph) == ()


def test_a_subscription_that_requests_more_than_we_offer_is_found() -> None:
    graph, looking = Graph(), survey(End("/cmd_vel", SCAN, "best effort", publishes=True))
    graph.subscriptions["/cmd_vel"] = [end("base", SCAN, "reliable")]

    (fault,) = looking.look(graph)

    assert (fault.kind, fault.name) == ("qos", "/cmd_vel")


def test_an_end_whose_node_is_still_being_discovered_is_not_told() -> None:
    graph, looking = Graph(), survey(End("/scan", SCAN, "reliable", publishes=False))
    graph.publishers["/scan"] = [end("_NODE_NAME_UNKNOWN_", SCAN, "best effort")]

    assert looking.look(graph) == ()


def test_our_own_other_end_is_no_measure_of_theirs() -> None:
    ends = [End("/scan", SCAN, "reliable", publishes=side) for side in (True, False)]
    graph, looking = Graph(), survey(*ends)
    graph.subscriptions["/scan"] = [end("viewer", SCAN, "best effort")]

    assert looking.look(graph) == ()


def test_another_type_is_found_which_ros_does_not_tell() -> None:
    graph, looking = Graph(), survey(End("/scan", SCAN, "reliable", publishes=False))
    graph.publishers["/scan"] = [end("camera", IMAGE, "reliable")]

    assert looking.look(graph) == (
        GraphFault(
            GraphFaultKind.TYPE, "/scan", f"/camera publishes {IMAGE}, and Pilothouse has {SCAN}"
        ),
    )


def test_two_nodes_of_one_name_are_found_in_their_namespace() -> None:
    graph = Graph()
    graph.names += [("arm", "/left"), ("arm", "/right"), ("base", "/"), ("base", "/")]

    assert survey().look(graph) == (
        GraphFault(GraphFaultKind.DUPLICATE, "/base", "2 nodes have this name"),
    )


def test_a_look_goes_through_few_topics_and_the_next_ones_through_the_others() -> None:
    topics = [f"/topic_{number}" for number in range(2 * TOPICS_AT_ONCE + 3)]
    graph = Graph()
    looking = survey(*(End(topic, SCAN, "reliable", publishes=False) for topic in topics))

    looking.look(graph)
    assert graph.asked == topics[:TOPICS_AT_ONCE]
    looking.look(graph)
    looking.look(graph)
    assert graph.asked == topics
    looking.look(graph)
    assert graph.asked[len(topics) :] == topics[:TOPICS_AT_ONCE]


def test_a_fault_is_known_until_its_topic_is_looked_at_again() -> None:
    topics = [f"/topic_{number}" for number in range(TOPICS_AT_ONCE + 1)]
    graph = Graph()
    looking = survey(*(End(topic, SCAN, "reliable", publishes=False) for topic in topics))
    graph.publishers["/topic_0"] = [end("lidar", SCAN, "best effort")]

    looking.look(graph)
    graph.publishers.clear()

    assert [fault.name for fault in looking.look(graph)] == ["/topic_0"]
    assert looking.look(graph) == ()
