"""What a robot file includes."""

from typing import Any

import pytest

from service.files.includes import InvalidIncludeError, Keys, with_includes

SCAN = {"name": "scan", "topic": "/scan", "type": "a/msg/B", "min_hz": 8.0, "max_gap_s": 0.5}


def test_a_template_adds_its_signals_to_those_of_the_file() -> None:
    merged = with_includes({"include": ["cpu"], "signals": {"load": {}}}).data

    assert merged["include"] == ["cpu"]
    assert set(merged["signals"]) == {"load", "cpu_load", "cpu_load_mean"}


def test_a_file_without_includes_is_as_it_is() -> None:
    assert with_includes({"signals": {"load": {}}}).data == {"signals": {"load": {}}}


def test_what_the_file_says_goes_before_what_a_template_says() -> None:
    own = {"include": ["cpu"], "signals": {"cpu_load_mean": {"above": 95.0}}}

    settings = with_includes(own).data["signals"]["cpu_load_mean"]

    assert (settings["above"], settings["error"]) == (95.0, "CPU_HIGH")
    assert own["signals"] == {"cpu_load_mean": {"above": 95.0}}


def test_a_template_adds_topics() -> None:
    own = {"include": [{"topic": SCAN}], "ros2": {"odometry": {"topic": "/odom"}}}

    ros2 = with_includes(own).data["ros2"]

    assert set(ros2) == {"odometry", "statistics"}
    assert set(ros2["statistics"]) == {"scan_rate", "scan_gap"}


def test_a_template_with_another_name_can_be_included_twice() -> None:
    second = {"disk": {"name": "data", "path": "/data"}}

    signals = with_includes({"include": ["disk", second]}).data["signals"]

    assert set(signals) == {"disk_used", "disk_time_left", "data_used", "data_time_left"}


@pytest.mark.parametrize(
    ("keys", "place"),
    [
        (("signals", "cpu_load_mean", "above"), ("signals", "cpu_load_mean", "above")),
        (("signals", "cpu_load_mean", "error"), ("include", 1)),
        (("signals", "cpu_load"), ("include", 1)),
        (("signals", "load", "unit"), ("signals", "load", "unit")),
        (("ros2", "statistics", "scan_rate", "type"), ("include", 0)),
        (("ros2", "odometry", "topic"), ("ros2", "odometry", "topic")),
        ((), ()),
    ],
)
def test_a_finding_is_where_the_file_says_it(keys: Keys, place: Keys) -> None:
    own = {
        "include": [{"topic": SCAN}, "cpu"],
        "signals": {"cpu_load_mean": {"above": 95.0}, "load": {}},
    }

    assert with_includes(own).place_of(keys) == place


@pytest.mark.parametrize(
    ("include", "keys", "message"),
    [
        ("cpu", (), "expected a list of templates, such as [cpu, memory]"),
        ([7], (0,), "expected the name of a template, or a name with its parameters below it"),
        (
            ["cpu", {"disk": {}, "memory": {}}],
            (1,),
            "expected the name of a template, or a name with its parameters below it",
        ),
        (["cpuu"], (0,), "there is no template 'cpuu'; did you mean cpu?"),
        ([{"disk": None}], (0, "disk"), "expected the parameters of disk below it"),
        (
            [{"disk": {"path": ["/"]}}],
            (0, "disk", "path"),
            "path must be a number, a word or true or false",
        ),
        (
            [{"disk": {"pth": "/"}}],
            (0, "disk", "pth"),
            "the template disk has no parameter 'pth'; did you mean path?",
        ),
        ([{"network": {}}], (0,), "the template network requires interface"),
        (["cpu"] * 101, (100,), "at most 100 templates"),
        (["cpu", "cpu"], (1,), "an earlier template has cpu_load already; give one another name"),
    ],
)
def test_what_cannot_be_included_is_told_at_its_place(
    include: object, keys: Keys, message: str
) -> None:
    with pytest.raises(InvalidIncludeError) as raised:
        with_includes({"include": include})

    assert raised.value.keys == ("include", *keys)
    assert raised.value.message == message


@pytest.mark.parametrize("own", [{"signals": 7}, {"ros2": []}, {"ros2": {"statistics": "x"}}])
def test_what_is_no_mapping_is_left_to_the_validation(own: dict[str, Any]) -> None:
    merged = with_includes({"include": [{"topic": SCAN}], **own}).data

    assert {key: merged[key] for key in own} == own


def test_a_signal_that_is_no_mapping_is_left_to_the_validation() -> None:
    merged = with_includes({"include": ["cpu"], "signals": {"cpu_load": 7}}).data

    assert merged["signals"]["cpu_load"] == 7
