"""`pilothouse profile`: measure how fast the robot is stopped and started."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command

_TEXT = """\
Measure on this machine how long it takes from a bad reading until a WebSocket
client sees the ERROR, the pause of the task and the zero drive command, and
from a good reading until it sees RUNNING, the resumed task and the next drive
command. Beside it, an echo (WebSocket ping) shows what of that is the way there
and back.

It starts a service of its own, with a simulated robot that drives, and ends it.
No running service is touched: false readings would stop a real robot, and false
good ones would hide its errors.

Each run of a trigger stops and starts the robot once. Errors that need time
(GPS_LOST 15 s, SIGNAL_LOST 10 s, SIGNAL_LOW 20 s, STALE_DATA 2 s) take that
long in each run; it is subtracted from the latencies. All seven together take
about one minute a run. After Ctrl-C, what was measured is kept and analysed.

--robot and MODEL are those of `pilothouse serve`; the robot file must have
mock: false. Times that differ from the defaults are named in the report.

The folder DIR gets runs.csv (raw: one line for each run and trigger, with the
times in s), setup.json, report.txt, report.json and, with --plot, latency.png;
from the service its data, service.log and, without --robot, robot.yaml.
--analyse makes the report again from CSV files, also of several profiles.

A run fails if something is not seen within 2 s after it was due, is seen before
it, or if another error is raised. It counts as failed and is listed.

examples:
  pilothouse profile --runs 100 --trigger ESTOP       only the e-stop, 3 min
  pilothouse profile --plot                           all seven triggers
  pilothouse profile --analyse profile/runs.csv --format json

exit code: 0 all runs succeeded; 1 a run failed, or the service did;
           2 a file cannot be read or written, or the plot cannot be drawn;
           130 ended by Ctrl-C
"""


_ERRORS = (
    "ESTOP",
    "BATTERY_LOW",
    "TEMPERATURE_HIGH",
    "STALE_DATA",
    "SIGNAL_LOST",
    "GPS_LOST",
    "SIGNAL_LOW",
)
"""Listed here, since `--help` loads nothing of the core."""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "model", nargs="?", type=Path, metavar="MODEL", help="model file; default: an example"
    )
    parser.add_argument("--robot", type=Path, metavar="FILE", help="robot file: settings")
    parser.add_argument(
        "--runs", type=_runs, default=10, metavar="N", help="runs of each trigger; default: 10"
    )
    parser.add_argument(
        "--trigger",
        action="append",
        choices=_ERRORS,
        metavar="ERROR",
        help=f"measure only this error; can be repeated; default: all of {', '.join(_ERRORS)}",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="folder of the results; default: a new one, profile-DATE-TIME",
    )
    parser.add_argument(
        "--plot", action="store_true", help="draw the distributions; needs pilothouse[plot]"
    )
    parser.add_argument(
        "--analyse",
        nargs="+",
        type=Path,
        metavar="CSV",
        help="measure nothing: make the report from earlier runs.csv; with --out, write it there",
    )
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="of the printed report"
    )


def _runs(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"invalid number of runs {number}; expected at least 1")
    return number


def _run(options: argparse.Namespace) -> int:
    from api.cli.profile_run import ProfileOptions, analyse, measure

    if options.analyse:
        return analyse(options.analyse, options.out, options.format, plot=options.plot)
    return measure(
        ProfileOptions(
            model=options.model,
            robot=options.robot,
            runs=options.runs,
            triggers=tuple(dict.fromkeys(options.trigger or _ERRORS)),
            out=options.out,
            form=options.format,
            plot=options.plot,
        )
    )


COMMAND = Command("profile", "measure how fast the robot is stopped", _TEXT, _add_options, _run)
