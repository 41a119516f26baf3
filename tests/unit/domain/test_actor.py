from domain.actor import NOBODY, Actor


def test_an_actor_is_shown_by_its_name_or_else_by_where_it_came_from() -> None:
    assert Actor("robot file").label == "robot file"
    assert Actor(way="http", address="10.0.0.7").label == "http:10.0.0.7"
    assert Actor("anna", way="http", address="10.0.0.7").label == "anna"
    assert Actor(way="ros").label == "ros"
    assert NOBODY.label == ""
