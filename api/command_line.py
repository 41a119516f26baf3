"""The command `pilothouse`: what it understands, and what it says when something goes wrong.

Modules are imported when a command needs them. So `--help` is quick, and `check_packages` can speak
before the import of a foreign package with the name of one of ours fails.
"""

import argparse
import math
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from api.distribution import ForeignPackageError, check_packages, installed_version

if TYPE_CHECKING:
    from api.client import Outcome, ServiceClient

SUCCEEDED, FAILED, MISUSED, INTERRUPTED = 0, 1, 2, 130

_DEFAULT_URL = "http://127.0.0.1:8000"
_MAX_WAIT_S = 3600.0
_TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")

_EXAMPLES = """\
examples:
  pilothouse serve                        the built-in robot, all simulated
  pilothouse check robot.yaml             is this model right?
  pilothouse serve robot.yaml --port 9000 supervise it, with simulated nodes
  pilothouse mode actuation PERFORMANCE   change a mode, and follow the steps
  pilothouse state drive_base deactivate  take a part through a transition
  pilothouse task track.csv --preview     look at waypoints before the drive
  pilothouse task track.csv               drive them, and follow how far it is
  pilothouse simulate scenario.yaml       does it go as expected?
"""
_SERVE = """\
Run the service until Ctrl-C or SIGTERM; then the vehicle is stopped, and nodes
are left as they are.

It listens on this machine only. Another --host makes it reachable for
everybody there, without a password: say --anonymous if that is what you want.
A page asks by the name in its address, so a name that is not this machine's
own must be told with --allowed-host.
"""
_CHECK = """\
Check a model file: all that is wrong, and what is odd, with line and column.

exit code: 0 valid, perhaps with warnings; 1 invalid
"""
_SIMULATE = """\
Let a scenario happen in virtual time, by the code that supervises a real
robot, and compare what is seen with what the scenario expects. No service is
needed, and nothing real is changed.

A scenario is YAML or JSON: the body of POST /simulations. Besides, it may name
model_file, robot_file and task: {file: track.csv}, beside the scenario.

  title: The battery runs low on the way
  until_s: 9
  robot: {signals: {stale_after_s: 0}}
  steps:
    - {t_s: 0, reading: {battery_level: 1.0}}
    - {t_s: 1, task: {file: track.csv, controller: stanley, heading: deg}}
    - {t_s: 4, reading: {battery_level: 0.4}}
    - {t_s: 4, expect: {system_state: {state: ERROR, errors: [BATTERY_LOW]}}}
    - {t_s: 9, expect: {vehicle: {speed_mps: 0}, events: {task.paused: 1}}}

What is expected are members of a sample as far as they matter, last_task (also
when it has ended), and events, counted by kind. A number may be {above: 1},
{below: 1}, {at_least: 1, at_most: 2}; a state with its mode is active.FAST.
A step that is refused fails the scenario, unless it says refused: true.

exit code: 0 all is as expected; 1 something is not, or a step was refused;
           2 invalid file
"""
_TASK = """\
Drive along the waypoints of a CSV, in place of the current task, and follow
that to its end. A line is x,y,yaw in m, m and rad; --heading says if yaw is
something else.

While something holds the vehicle, as an error does, the task waits. Ctrl-C
ends the following only: the task goes on, and --cancel ends it.

exit code: 0 succeeded, or as asked; 1 refused, canceled or aborted;
           2 unknown: no answer
"""
_CHANGE = """\
exit code: 0 succeeded; 1 refused or failed;
           2 unknown: not ended in time, or no answer
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code.

    Args:
        arguments: Those after the name of the command; None: those of the process.
    """
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.run is None:
        parser.print_help()
        return MISUSED
    try:
        check_packages()
        code: int = options.run(options)
        sys.stdout.flush()
    except ForeignPackageError as error:
        _complain(str(error))
        return FAILED
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # Who read our output went away, as `head` does; the interpreter would complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return FAILED
    return code


# --- what is understood --------------------------------------------------------------------------


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="pilothouse",
        description="Supervise a robot: what it is in, what it should be in, and why.",
        epilog=_EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"pilothouse {installed_version()}")
    parser.set_defaults(run=None)
    commands = parser.add_subparsers(metavar="COMMAND", title="commands")

    def command(name: str, about: str, text: str, run: Callable[..., int]) -> _Parser:
        added = commands.add_parser(
            name,
            help=about,
            description=text,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        added.set_defaults(run=run)
        return added

    _add_serve_options(command("serve", "run the service", _SERVE, _serve))
    _add_check_options(command("check", "check a model file", _CHECK, _check))
    about = "change the mode of a system or node"
    _add_mode_options(command("mode", about, f"{about.capitalize()}.\n\n{_CHANGE}", _mode))
    about = "take a system or node through a lifecycle transition"
    _add_state_options(command("state", about, f"{about.capitalize()}.\n\n{_CHANGE}", _state))
    about = "drive along waypoints, or cancel that"
    _add_task_options(command("task", about, _TASK, _task))
    about = "let a scenario happen in virtual time"
    _add_simulate_options(command("simulate", about, _SIMULATE, _simulate))
    return parser


_Parser = argparse.ArgumentParser


def _add_serve_options(parser: _Parser) -> None:
    parser.add_argument(
        "model", nargs="?", type=Path, metavar="MODEL", help="model file; default: the example"
    )
    parser.add_argument("--robot", type=Path, metavar="FILE", help="robot file: settings")
    parser.add_argument("--host", default="127.0.0.1", help="address to listen on; %(default)s")
    parser.add_argument(
        "--port", default=8000, type=_port, help="%(default)s; 0 takes a free one and prints it"
    )
    parser.add_argument(
        "--anonymous", action="store_true", help="let everybody in who reaches another --host"
    )
    parser.add_argument(
        "--mock-signals", action="store_true", help="publish held values for the five signals"
    )
    parser.add_argument(
        "--allowed-host",
        action="append",
        default=[],
        metavar="NAME",
        help="name in the address by which this service may be asked; repeat for more",
    )
    parser.add_argument(
        "--log-level", default="info", choices=("debug", "info", "warning", "error")
    )


def _add_check_options(parser: _Parser) -> None:
    parser.add_argument("model", metavar="MODEL", help="model file; - reads standard input")
    parser.add_argument("--format", default="text", choices=("text", "json"))


def _add_mode_options(parser: _Parser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument("mode", metavar="MODE", help="name of one of its modes")
    _add_service_options(parser)


def _add_state_options(parser: _Parser) -> None:
    parser.add_argument("part", metavar="PART", help="name of a system or node")
    parser.add_argument(
        "transition", metavar="TRANSITION", choices=_TRANSITIONS, help=", ".join(_TRANSITIONS)
    )
    _add_service_options(parser)


def _add_simulate_options(parser: _Parser) -> None:
    parser.add_argument(
        "scenario", metavar="SCENARIO", help="scenario file; - reads standard input"
    )
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="json: all that happened"
    )
    parser.add_argument(
        "--robot", type=Path, metavar="FILE", help="robot file instead of that of the scenario"
    )
    parser.add_argument(
        "--model", type=Path, metavar="FILE", help="model file instead of that of the scenario"
    )


def _add_task_options(parser: _Parser) -> None:
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("file", nargs="?", metavar="FILE", help="CSV; - reads standard input")
    what.add_argument("--cancel", action="store_true", help="end the current task, and stand")
    parser.add_argument("--controller", metavar="NAME", help="pure_pursuit (default) or stanley")
    parser.add_argument(
        "--speed", type=float, metavar="MPS", help="cruise speed in m/s; default: 2.8"
    )
    parser.add_argument(
        "--heading",
        choices=("rad", "deg", "compass"),
        help="what the third column is: rad (default) or deg, counter-clockwise from east;"
        " compass: degrees clockwise from north",
    )
    parser.add_argument(
        "--start-index", type=int, metavar="N", help="waypoint to begin with; default: 0"
    )
    parser.add_argument(
        "--preview", action="store_true", help="say what there is to know, start nothing"
    )
    parser.add_argument(
        "--wait",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="follow the task to its end (default), or only start it",
    )
    _add_url(parser)


def _add_url(parser: _Parser) -> None:
    parser.add_argument(
        "--url",
        default=os.environ.get("PILOTHOUSE_URL") or _DEFAULT_URL,
        help="where the service runs; default: PILOTHOUSE_URL, else " + _DEFAULT_URL,
    )


def _add_service_options(parser: _Parser) -> None:
    _add_url(parser)
    parser.add_argument(
        "--wait",
        default=60.0,
        type=_wait_s,
        metavar="S",
        help="seconds to wait for the end; %(default)g",
    )
    parser.add_argument("--dry-run", action="store_true", help="say the steps, change nothing")


def _port(text: str) -> int:
    number = int(text)
    if not 0 <= number <= 65_535:
        raise argparse.ArgumentTypeError(f"{number} is no port: 0 to 65535")
    return number


def _wait_s(text: str) -> float:
    number = float(text)
    if not (math.isfinite(number) and 0 <= number <= _MAX_WAIT_S):
        raise argparse.ArgumentTypeError(f"{text} is not within 0 to {_MAX_WAIT_S:g} seconds")
    return number


# --- what is done --------------------------------------------------------------------------------


def _serve(options: argparse.Namespace) -> int:
    from api.serving import ServeOptions, serve

    return serve(
        ServeOptions(
            model=options.model,
            robot=options.robot,
            host=options.host,
            port=options.port,
            anonymous=options.anonymous,
            mock_signals=options.mock_signals,
            allowed_hosts=tuple(options.allowed_host),
            log_level=options.log_level,
        )
    )


def _check(options: argparse.Namespace) -> int:
    from api.model_check import check

    return check(options.model, options.format)


def _simulate(options: argparse.Namespace) -> int:
    from api.serving import EXAMPLE
    from api.simulate_command import simulate

    return simulate(options.scenario, options.format, EXAMPLE, options.model, options.robot)


def _task(options: argparse.Namespace) -> int:
    from api.task_command import TaskOptions, cancel, run_task

    if options.cancel:
        return _with_service(options.url, lambda client: cancel(client, print))
    asked = TaskOptions(
        file=options.file,
        controller=options.controller,
        speed_mps=options.speed,
        heading=options.heading,
        start_index=options.start_index,
        preview=options.preview,
        wait=options.wait,
    )
    return _with_service(options.url, lambda client: run_task(client, asked, print))


def _mode(options: argparse.Namespace) -> int:
    return _change(options, "mode", {"mode": options.mode})


def _state(options: argparse.Namespace) -> int:
    return _change(options, "state", {"transition": options.transition})


def _change(options: argparse.Namespace, what: str, request: dict[str, str]) -> int:
    from api.client import change, show_plan

    def run(client: "ServiceClient") -> "Outcome":
        if options.dry_run:
            return show_plan(client, options.part, what, request, print)
        return change(client, options.part, what, request, options.wait, print)

    return _with_service(options.url, run)


def _with_service(url: str, run: Callable[["ServiceClient"], "Outcome"]) -> int:
    from api.client import NoAnswerError, Outcome, ServiceProblemError, refusal_lines, service_at

    try:
        with service_at(url) as client:
            return run(client)
    except ServiceProblemError as error:
        for line in refusal_lines(error.problem):
            print(line, file=sys.stderr)
        return Outcome.FAILED
    except NoAnswerError as error:
        _complain(str(error))
        return Outcome.UNKNOWN


def _complain(message: str) -> None:
    print(f"pilothouse: {message}", file=sys.stderr)
