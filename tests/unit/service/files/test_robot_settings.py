import pytest
from pydantic import ValidationError

from domain.errors import InvalidValueError
from domain.health.signals import SignalSettings, default_signals
from domain.timebase import seconds
from service.files.robot_settings import ChangesBlock, NodeBlock, SignalsBlock


def signals(settings: dict[str, object]) -> dict[str, SignalSettings]:
    block = SignalsBlock.model_validate(settings)
    return {signal.spec.name: signal for signal in block.to_domain()}


def test_signals_of_which_nothing_is_said_are_as_usual() -> None:
    assert SignalsBlock().to_domain() == default_signals()


def test_thresholds_and_times_are_those_that_are_said() -> None:
    battery = signals(
        {
            "battery_level": {
                "threshold": 0.3,
                "clear_threshold": 0.35,
                "for_s": 1.5,
                "stale_after_s": 4,
                "min_on_s": 0,
                "clear_for_s": 3,
                "recovery": "acknowledge",
            }
        }
    )["battery_level"]

    assert battery.facts() == {
        "label": "battery",
        "error": "BATTERY_LOW",
        "severity": "critical",
        "bad_side": "below",
        "threshold": 0.3,
        "clear_threshold": 0.35,
        "for_s": 1.5,
        "stale_after_s": 4.0,
        "min_on_s": 0.0,
        "clear_for_s": 3.0,
        "recovery": "acknowledge",
        "minimum": 0.0,
        "maximum": 1.0,
    }


def test_signal_strength_has_a_time_for_each_of_its_errors() -> None:
    facts = signals({"signal_strength": {"lost_for_s": 3, "low_for_s": 7}})[
        "signal_strength"
    ].facts()

    assert (facts["lost_for_s"], facts["low_for_s"]) == (3.0, 7.0)


def test_one_time_holds_for_both_errors_of_the_signal_strength() -> None:
    facts = signals({"signal_strength": {"lost_for_s": 3, "for_s": 7}})["signal_strength"].facts()

    assert (facts["lost_for_s"], facts["low_for_s"]) == (3.0, 7.0)


def test_staleness_can_be_set_for_all_signals_and_for_each() -> None:
    settings = signals(
        {
            "stale_after_s": 0,
            "gps_accuracy": {"stale_after_s": 3},
            "motor_current": {"unit": "A"},
            "oil_pressure": {"stale_after_s": 5},
        }
    )

    stale_after = {name: signal.stale_after for name, signal in settings.items()}
    assert stale_after == {
        "battery_level": 0,
        "estop": 0,
        "gps_accuracy": seconds(3),
        "signal_strength": 0,
        "temperature": 0,
        "motor_current": 0,
        "oil_pressure": seconds(5),
    }


def test_a_further_signal_can_be_declared_with_an_error_of_its_own() -> None:
    motor = signals(
        {
            "motor_current": {
                "label": "motor current",
                "unit": "A",
                "minimum": 0,
                "maximum": 400,
                "above": 250,
                "clear_threshold": 220,
                "for_s": 3,
                "error": "MOTOR_OVERLOAD",
            }
        }
    )["motor_current"]
    (bound,) = motor.bounds

    assert (motor.spec.label, motor.spec.unit) == ("motor current", "A")
    assert (bound.error, bound.bit) == ("MOTOR_OVERLOAD", 128)
    assert bound.is_met_by(251.0)
    assert not bound.is_met_by(250.0)
    assert bound.is_met_by(230.0, error_is_on=True)
    assert motor.facts()["for_s"] == 3.0


def test_the_error_of_a_declared_signal_may_be_at_its_low_end() -> None:
    (bound,) = signals({"oil_pressure": {"below": 1.2, "error": "OIL_LOW"}})["oil_pressure"].bounds

    assert bound.is_met_by(1.1)
    assert not bound.is_met_by(1.2)


def test_a_declared_signal_may_be_there_to_be_looked_at() -> None:
    assert signals({"fuel": {"unit": "l"}})["fuel"].bounds == ()


@pytest.mark.parametrize(
    "settings",
    [
        pytest.param({"battery_level": {"treshold": 0.3}}, id="a slip of the pen"),
        pytest.param({"battery_level": {"threshold": "0.3"}}, id="a text for a number"),
        pytest.param({"battery_level": {"threshold": True}}, id="a boolean for a number"),
        pytest.param({"battery_level": {"threshold": float("nan")}}, id="not a number"),
        pytest.param({"battery_level": {"for_s": -1}}, id="a negative time"),
        pytest.param({"estop": {"threshold": 1}}, id="a threshold of a switch"),
        pytest.param({"signal_strength": {"threshold": 1}}, id="a threshold of what is no number"),
        pytest.param({"estop": {"recovery": "never"}}, id="no way to recover"),
        pytest.param({"Motor": {"unit": "A"}}, id="a name in capitals"),
        pytest.param({"motor": {"above": 1, "below": 0, "error": "X"}}, id="above and below"),
        pytest.param({"motor": {"above": 1}}, id="a threshold without an error"),
        pytest.param({"motor": {"error": "X"}}, id="an error without a threshold"),
        pytest.param({"motor": {"for_s": 1}}, id="a time without an error"),
        pytest.param({"motor": {"minimum": 2, "maximum": 1}}, id="an empty range"),
        pytest.param({"motor": {"above": 1, "error": "motor hot"}}, id="no name of an error"),
        pytest.param({"motor": {"above": 1, "error": "ESTOP"}}, id="the name of another error"),
        pytest.param({"motor": {"above": 1, "error": "STALE_DATA"}}, id="the name of staleness"),
        pytest.param(
            {"a": {"above": 1, "error": "X"}, "b": {"above": 1, "error": "X"}}, id="one name twice"
        ),
    ],
)
def test_what_cannot_be_meant_is_refused(settings: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        SignalsBlock.model_validate(settings)


@pytest.mark.parametrize(
    ("settings", "pointer"),
    [
        ({"battery_level": {"threshold": 2}}, "battery_level/threshold"),
        ({"battery_level": {"clear_threshold": 0.2}}, "battery_level/clear_threshold"),
        ({"motor": {"above": 5, "maximum": 3, "error": "X"}}, "motor/threshold"),
    ],
)
def test_a_threshold_that_can_never_be_reached_is_refused(
    settings: dict[str, object], pointer: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        signals(settings)

    assert caught.value.pointer == pointer


def test_a_node_that_returns_is_left_unless_it_is_said_that_it_is_restored() -> None:
    assert NodeBlock().on_return == "leave"
    with pytest.raises(ValidationError):
        NodeBlock.model_validate({"on_return": "activate"})


def test_a_change_has_deadlines_that_can_be_set() -> None:
    assert ChangesBlock() == ChangesBlock(transition_deadline_s=10.0, parameters_deadline_s=2.0)
    with pytest.raises(ValidationError):
        ChangesBlock.model_validate({"transition_deadline_s": -1})
