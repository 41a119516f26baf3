"""Templates, as pieces of a robot file with placeholders."""

from pathlib import Path

import pytest

from domain.errors import InvalidValueError
from service.files.monitor_templates import TEMPLATES, Parameter, read_template, template_text

EXAMPLES = Path(__file__).resolve().parents[4] / "examples" / "monitors"


def test_the_examples_are_the_templates() -> None:
    assert tuple(sorted(path.stem for path in EXAMPLES.glob("*.yaml"))) == TEMPLATES


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_template_says_what_it_declares_and_when_it_raises_an_error(name: str) -> None:
    comment = "".join(line for line in template_text(name).splitlines() if line[:1] == "#")
    template = read_template(name)
    required = {parameter: f"<{parameter}>" for parameter in template.requires}
    given = {**required, **{key: f"<{key}>" for key in template.defaults}}

    for signal, settings in template.filled(given)["signals"].items():
        assert signal in comment
        assert settings.get("error", signal) in comment


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_parameter_of_a_template_is_used(name: str) -> None:
    template = read_template(name)

    unused = [
        parameter
        for parameter in (*template.requires, *template.defaults)
        if f"<{parameter}>" not in template_text(name)
    ]

    assert not unused


def test_a_parameter_stands_for_itself_and_for_a_part_of_a_name() -> None:
    given: dict[str, Parameter] = {
        "name": "scan",
        "topic": "/scan",
        "type": "sensor_msgs/msg/LaserScan",
        "min_hz": 8,
        "max_gap_s": 0.5,
    }

    filled = read_template("topic").filled(given)

    assert filled["signals"]["scan_rate"] == {
        "unit": "Hz",
        "minimum": 0.0,
        "below": 8,
        "error": "SCAN_SLOW",
        "severity": "urgent",
    }
    assert filled["ros2"]["statistics"]["scan_gap"] == {
        "topic": "/scan",
        "type": "sensor_msgs/msg/LaserScan",
        "statistic": "gap",
        "window_s": 5.0,
    }


def test_a_key_with_an_empty_parameter_is_left_out() -> None:
    without = read_template("motor").filled({})
    with_part = read_template("motor").filled({"part": "drive_left"})

    assert "part" not in without["signals"]["motor_current"]
    assert with_part["signals"]["motor_current"]["part"] == "drive_left"


@pytest.mark.parametrize(
    ("name", "given", "pointer", "message"),
    [
        (
            "cpu",
            {"hihg": 80},
            "hihg",
            "the template cpu has no parameter 'hihg'; did you mean high?",
        ),
        (
            "cpu",
            {"x": 80},
            "x",
            "the template cpu has no parameter 'x'; it has high, normal, window_s, severity",
        ),
        ("network", {}, "interface", "the template network requires interface"),
    ],
)
def test_parameters_have_to_fit(
    name: str, given: dict[str, float], pointer: str, message: str
) -> None:
    with pytest.raises(InvalidValueError) as raised:
        read_template(name).filled(given)

    assert (raised.value.pointer, raised.value.message) == (pointer, message)


@pytest.mark.parametrize(
    ("name", "hint"), [("cpuu", "did you mean cpu?"), ("../secrets", "there are battery, ")]
)
def test_only_templates_are_opened(name: str, hint: str) -> None:
    with pytest.raises(InvalidValueError, match=hint):
        read_template(name)
