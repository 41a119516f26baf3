from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from domain.circles import circles, in_words


def test_what_leads_forward_only_has_no_circle() -> None:
    assert list(circles({"a": ["b", "c"], "b": ["c"], "d": ["a"]})) == []


def test_a_circle_is_told_from_a_node_back_to_itself_without_the_way_into_it() -> None:
    assert list(circles({"start": ["a"], "a": ["b"], "b": ["a", "c"]})) == [("a", "b", "a")]


def test_a_node_that_leads_to_itself_is_a_circle() -> None:
    assert list(circles({"a": ["a"]})) == [("a", "a")]


def test_each_of_several_circles_is_told() -> None:
    assert list(circles({"a": ["a"], "b": ["c"], "c": ["b"]})) == [("a", "a"), ("b", "c", "b")]


GRAPHS = st.dictionaries(st.integers(0, 8), st.lists(st.integers(0, 8), max_size=4))


@given(GRAPHS)
def test_circles_are_told_exactly_if_no_order_of_the_nodes_exists(
    graph: dict[int, list[int]],
) -> None:
    left = dict(graph)
    # Take away what leads nowhere, until nothing changes: what is left, leads in circles.
    while ends := [node for node, nexts in left.items() if not set(nexts) & left.keys()]:
        for node in ends:
            del left[node]

    told = list(circles(graph))

    assert bool(told) == bool(left)
    for circle in told:
        assert circle[0] == circle[-1]
        assert all(after in graph[before] for before, after in pairwise(circle))


def test_a_long_circle_is_told_by_its_ends() -> None:
    names = [f"s{number}" for number in range(100)]

    assert in_words(names[:3], " > ") == "s0 > s1 > s2"
    assert in_words(names, " > ").endswith("s9 > ... > s98 > s99")
