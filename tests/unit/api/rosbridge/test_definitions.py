"""The definitions that viewers get are those of the packages."""

from api.rosbridge.definitions import MESSAGES, SERVICES, full_text, type_definitions
from service.ros.interface.interface import RosInterface
from service.ros.interface.message_sets import ALIASES
from tests.support.live_robot import make_supervisor
from tests.unit.examples.test_ros2_interfaces import DECLARED


def test_every_type_that_is_offered_is_defined() -> None:
    interface = RosInterface(make_supervisor())
    published = {topic.type for topic in interface.topics.values()}
    heard = {topic.type for topic in interface.heard.values()}

    assert published | heard <= {*MESSAGES}
    assert {service.type for service in interface.services.values()} == {*SERVICES}


def test_the_types_that_are_shipped_as_source_are_the_same() -> None:
    for file, lines in DECLARED.items():
        name, _, kind = file.rpartition(".")
        package = name.partition("/")[0]
        if kind == "msg":
            found = [line.replace(f"{package}/", "") for line in MESSAGES[name]]
        elif kind == "srv":
            request, response = SERVICES[name]
            found = [line.replace(f"{package}/", "") for line in (*request, "---", *response)]
        else:
            # rosbridge has no actions here.
            continue
        assert found == lines, file


def test_a_message_is_defined_under_both_of_its_names() -> None:
    for alias, own in ALIASES.items():
        assert full_text(alias) == full_text(own) != ""


def test_every_type_in_a_type_is_defined() -> None:
    for name in MESSAGES:
        defined = {each["type"] for each in type_definitions(name)}
        named = {t for each in type_definitions(name) for t in each["fieldtypes"] if "/" in t}
        assert named <= defined


def test_the_text_of_an_unknown_type_is_empty() -> None:
    assert full_text("nothing/msg/Here") == ""
