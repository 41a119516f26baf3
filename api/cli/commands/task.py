"""`pilothouse task`: drive along waypoints, or cancel that."""

import argparse

from api.cli.commands.command import Command, add_url, with_service

_TEXT = """\
Drive along the waypoints of a CSV, in place of the current task, and follow
that to its end. A line is x,y,yaw in m, m and rad; --heading says if yaw is
something else.

While something holds the vehicle, as an error does, the task waits. Ctrl-C
ends the following only: the task goes on, and --cancel ends it.

exit code: 0 succeeded, or as asked; 1 refused, canceled or aborted;
           2 unknown: no answer
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
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
    add_url(parser)


def _run(options: argparse.Namespace) -> int:
    from api.cli.task_command import TaskOptions, cancel, run_task

    if options.cancel:
        return with_service(options.url, lambda client: cancel(client, print))
    asked = TaskOptions(
        file=options.file,
        controller=options.controller,
        speed_mps=options.speed,
        heading=options.heading,
        start_index=options.start_index,
        preview=options.preview,
        wait=options.wait,
    )
    return with_service(options.url, lambda client: run_task(client, asked, print))


COMMAND = Command("task", "drive along waypoints, or cancel that", _TEXT, _add_options, _run)
