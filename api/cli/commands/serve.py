"""`pilothouse serve`: run the service."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command

_TEXT = """\
Run the service until Ctrl-C or SIGTERM; then the vehicle is stopped, and nodes
are left as they are.

It listens on this machine only. Another --host makes it reachable for others:
give it a token by PILOTHOUSE_TOKEN, or by PILOTHOUSE_TOKEN_FILE the name of a
file that holds it; or say --anonymous if everybody may use it. A page asks
by the name in its address, so a name that is not this machine's own must be
told with --allowed-host.

With --backend ros2 the nodes are those of ROS 2 in the domain that
ROS_DOMAIN_ID names. Source the setup.bash of its distribution first. Who is in
that domain needs no token.
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "model", nargs="?", type=Path, metavar="MODEL", help="model file; default: the example"
    )
    parser.add_argument("--robot", type=Path, metavar="FILE", help="robot file: settings")
    parser.add_argument(
        "--backend",
        choices=("simulated", "ros2"),
        help="through what nodes are reached; default: as the robot file says, or simulated",
    )
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


def _port(text: str) -> int:
    number = int(text)
    if not 0 <= number <= 65_535:
        raise argparse.ArgumentTypeError(f"{number} is no port: 0 to 65535")
    return number


def _run(options: argparse.Namespace) -> int:
    from api.serving.composition import ServeOptions
    from api.serving.serving import serve

    return serve(
        ServeOptions(
            model=options.model,
            robot=options.robot,
            backend=options.backend,
            host=options.host,
            port=options.port,
            anonymous=options.anonymous,
            mock_signals=options.mock_signals,
            allowed_hosts=tuple(options.allowed_host),
            log_level=options.log_level,
        )
    )


COMMAND = Command("serve", "run the service", _TEXT, _add_options, _run)
