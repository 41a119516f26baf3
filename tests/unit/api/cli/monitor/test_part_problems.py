from typing import Any

from api.cli.monitor.part_problems import part_problems
from tests.support.monitor import device, named, off_target, part, system

OFF: dict[str, Any] = {"converged": False, "target": {"state": "active", "mode": "FAST"}}


def test_a_robot_as_it_should_be_has_no_problems() -> None:
    assert part_problems(named("name", system("robot", "a"), part("a"))) == []


def test_a_node_explains_why_its_system_deviates_however_deep_it_is() -> None:
    parts = named(
        "name", system("robot", "arm", **OFF), system("arm", "joint", **OFF), off_target("joint")
    )

    assert part_problems(parts) == ["joint is inactive, target active.FAST"]


def test_a_system_that_nothing_below_explains_is_named() -> None:
    parts = named("name", system("robot", "a", **OFF), part("a"))

    assert part_problems(parts) == ["robot is active, target active.FAST"]


def test_only_the_first_three_are_named_and_the_others_counted() -> None:
    parts = named("name", *(part(f"n{number}", reachable=False) for number in range(9)))

    assert part_problems(parts)[-1] == "6 more such parts"
    assert len(part_problems(parts)) == 4
    four = dict(list(parts.items())[:4])
    assert part_problems(four)[-1] == "1 more such part"


def test_a_device_that_is_away_stands_for_its_parts_and_what_is_above_them() -> None:
    parts = named(
        "name",
        system("robot", "arm", "lidar", **OFF),
        part("arm", reachable=False, device="arm_computer"),
        part("lidar", reachable=False, device=None),
    )
    devices = named("device", device("arm_computer", "lost"))

    assert part_problems(parts, devices) == ["device arm_computer is lost", "lidar is unreachable"]


def test_a_node_that_is_dead_on_a_device_that_is_heard_is_named() -> None:
    parts = named("name", part("arm", reachable=False, device="arm_computer"))

    devices = named("device", device("arm_computer"))
    assert part_problems(parts, devices) == ["arm is unreachable"]
