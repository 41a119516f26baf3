from argparse import ArgumentParser

from api.cli.commands.profile import COMMAND
from api.profiling.triggers import GOOD, TRIGGERS, changed_settings
from domain.health.signals import STALE_DATA, default_signals
from tests.support.profiled_robot import SETTINGS


def test_every_error_of_the_default_signals_has_a_trigger() -> None:
    errors = {bound.error for signal in default_signals() for bound in signal.bounds} | {STALE_DATA}

    assert set(TRIGGERS) == errors
    assert set(GOOD) == {signal.spec.name for signal in default_signals()}


def test_the_command_knows_the_triggers_without_loading_them() -> None:
    parser = ArgumentParser()
    COMMAND.add_options(parser)

    for error in TRIGGERS:
        assert parser.parse_args(["--trigger", error]).trigger == [error]
    assert ", ".join(TRIGGERS) in " ".join(parser.format_help().split())


def test_the_bad_reading_meets_the_bound_and_the_good_one_none() -> None:
    signals = {signal.spec.name: signal for signal in default_signals()}
    for trigger in TRIGGERS.values():
        signal = signals[trigger.signal]
        bounds = {bound.error: bound for bound in signal.bounds}
        good = signal.spec.checked(GOOD[trigger.signal])
        assert not any(bound.is_met_by(good) for bound in bounds.values())
        if trigger.bad is not None:
            assert bounds[trigger.error].is_met_by(signal.spec.checked(trigger.bad))
            assert trigger.counts_from is signal.counts_from


def test_the_persistence_is_that_of_the_running_service() -> None:
    persistences = {error: trigger.persistence_s(SETTINGS) for error, trigger in TRIGGERS.items()}

    assert persistences == {
        "ESTOP": 0,
        "BATTERY_LOW": 0,
        "TEMPERATURE_HIGH": 0,
        "STALE_DATA": 2,
        "SIGNAL_LOST": 10,
        "GPS_LOST": 15,
        "SIGNAL_LOW": 20,
    }


def test_times_that_were_set_otherwise_are_named() -> None:
    shorter = {**SETTINGS, "gps_accuracy": {**SETTINGS["gps_accuracy"], "for_s": 0.5}}

    assert not list(changed_settings(SETTINGS))
    assert list(changed_settings(shorter)) == ["gps_accuracy.for_s is 0.5 (default 15)"]
