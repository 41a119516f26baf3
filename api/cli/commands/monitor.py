"""`pilothouse monitor`: watch a robot in a terminal."""

import argparse

from api.cli.commands.command import DEFAULT_URL, Command, answered, default_url

_TEXT = """\
Watch a robot in this terminal until Ctrl-C: how it is and why, its systems and
nodes with their targets, its signals and its task. It only looks.

Each part has a line: the target, then the state and the mode that it is in;
(*) marks what is inferred, not reported. What needs attention is marked:
  ! deviates from its target       > is under a running change
  x a node is not reachable
On a screen that is too short, marked lines come first, and the rest is counted.
Contact that is lost is told, and comes back by itself.

  pilothouse monitor                          the service on this machine
  pilothouse monitor http://robot.local:8000  another one
  ssh -t robot pilothouse monitor             over ssh; -t gives it a terminal
  pilothouse monitor > robot.log              a picture for each change
  pilothouse monitor --once                   one picture, and the end
  pilothouse monitor --once --format json | jq .system_state.state

Where the output is no terminal, it is plain text, a new picture whenever a
state, mode, target, hold or the status of the task changes. --format json
writes one JSON object per such change, on a terminal too:
{at, system_state, parts, signals, task, vehicle, emergency_stop, holds}.

environment:
  PILOTHOUSE_URL         where the service runs, if no URL is given
  PILOTHOUSE_TOKEN       token to show; or the name of a file that holds it in
  PILOTHOUSE_TOKEN_FILE
  NO_COLOR               no colours
  COLUMNS                width where there is no terminal; default: 80

exit code: 0 ended by Ctrl-C, or --once has a picture, also of a robot in ERROR;
           1 refused, as without the right token; 2 no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "url",
        nargs="?",
        default=default_url(),
        metavar="URL",
        help="where the service runs; default: PILOTHOUSE_URL, else " + DEFAULT_URL,
    )
    parser.add_argument("--once", action="store_true", help="show one picture, and end")
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="json: as in the interface"
    )


def _run(options: argparse.Namespace) -> int:
    from api.cli.monitor.monitor import monitor

    return answered(lambda: monitor(options.url, options.format, once=options.once))


COMMAND = Command("monitor", "watch a robot in a terminal", _TEXT, _add_options, _run)
