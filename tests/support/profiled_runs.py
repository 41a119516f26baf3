"""Runs of a profile, as a test wants them."""

from api.profiling.run_file import Run

AT = "2026-01-01T00:00:00.000Z"


def ok_run(
    number: int = 1,
    trigger: str = "ESTOP",
    *,
    stop_s: float = 0.002,
    start_s: float = 0.003,
    persistence_s: float = 0.0,
) -> Run:
    """Return a run that succeeded, with echoes of 1 and 2 ms.

    Args:
        number: Number of the run.
        trigger: The error.
        stop_s: What the stop took after the persistence.
        start_s: What the start took.
        persistence_s: The persistence.
    """
    stopped, started = 100.0 + persistence_s + stop_s, 150.0 + start_s
    times = {"counts_from_s": 100.0, "first_bad_s": 100.05, "first_good_s": 150.0}
    times |= dict.fromkeys(("error_s", "pause_s", "zero_s"), stopped)
    times |= dict.fromkeys(("running_s", "resume_s", "drive_s"), started)
    return Run(number, trigger, AT, persistence_s, times | {"echo_1_s": 0.001, "echo_2_s": 0.002})


def failed_run(number: int = 1, trigger: str = "ESTOP") -> Run:
    """Return a run that saw the stop after 2 ms, and no start."""
    seen = {
        name: time
        for name, time in ok_run().times.items()
        if name not in ("running_s", "resume_s", "drive_s")
    }
    return Run(number, trigger, AT, 0.0, seen, "not seen within 2 s: running, resume, drive")
