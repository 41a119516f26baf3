from domain.devices.own_signals import readable_signals, signals_of_device
from domain.health.signals import SignalSettings, default_signals
from domain.inputs import TimePassed
from domain.snapshot import SystemState
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from service.files.robot_file import read_robot_file
from tests.support.models import BASE, actuation_model

MODEL = actuation_model()


def signals(text: str) -> tuple[SignalSettings, ...]:
    return read_robot_file(text, MODEL).to_signal_settings()


def names(found: tuple[SignalSettings, ...]) -> list[str]:
    return [signal.spec.name for signal in found]


def test_monitors_go_with_what_they_are_computed_from() -> None:
    every = signals(
        "signals: {motor: {}, mean: {of: motor, statistic: mean, window_s: 5},"
        " peak: {of: mean, statistic: max, window_s: 5},"
        " cold: {of: temperature, statistic: min, window_s: 5}}"
    )

    assert names(readable_signals(every, {"motor"})) == ["motor", "mean", "peak"]


def test_a_device_has_what_it_reads_and_the_stop() -> None:
    found = signals_of_device(signals("signals: {motor: {}}"), {"motor"}, {BASE})

    assert names(found) == ["estop", "motor"]


def test_a_stop_that_nobody_reads_here_never_goes_stale() -> None:
    (stop,) = signals_of_device(default_signals(), (), {BASE})

    assert stop.stale_after == 0


def test_a_stop_that_is_read_here_goes_stale_as_usual() -> None:
    (stop,) = signals_of_device(default_signals(), {"estop"}, {BASE})

    assert stop.stale_after == seconds(2)


def test_a_device_without_a_vehicle_is_in_no_error_for_what_it_does_not_have() -> None:
    own = signals_of_device(default_signals(), (), {BASE})
    core = Supervision(MODEL, SupervisionSettings(own), 0)

    core.handle(TimePassed(), seconds(60))

    assert core.system_state().state is SystemState.IDLE


def test_errors_of_foreign_parts_are_found_elsewhere() -> None:
    every = signals("signals: {load: {above: 3, error: OVERLOAD, part: actuation}}")

    (_, load) = signals_of_device(every, {"load"}, {BASE})

    assert (load.bounds, load.part) == ((), None)


def test_limits_by_the_mode_of_a_foreign_part_are_judged_elsewhere() -> None:
    every = signals(
        "signals: {load: {error: OVERLOAD, part: drive_base,"
        " limits: {actuation.PERFORMANCE: {above: 3}}}}"
    )

    (_, load) = signals_of_device(every, {"load"}, {BASE})

    assert load.limits == ()


def test_errors_of_its_own_parts_are_found_at_the_device() -> None:
    every = signals("signals: {load: {above: 3, error: OVERLOAD, part: drive_base}}")

    (_, load) = signals_of_device(every, {"load"}, {BASE})

    assert load.value_errors == ("OVERLOAD",)
