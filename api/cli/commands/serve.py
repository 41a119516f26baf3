"""`pilothouse serve`: run the service."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from api.cli.commands.command import Command, port
from api.serving.data_folder import USUAL

if TYPE_CHECKING:
    # When the command runs, and not for `--help`: it brings the whole service.
    from api.serving.composition import ServeOptions

_TEXT = """\
Run the service until Ctrl-C, SIGTERM or SIGHUP (an ssh session that closes);
then the vehicle is stopped, and nodes keep their states. nohup is respected.

By default it listens on this machine only. To make it reachable with --host,
set a token with PILOTHOUSE_TOKEN, or a file with the token with
PILOTHOUSE_TOKEN_FILE; or use --anonymous to allow everybody. Browsers send the
host name of the URL: allow a name other than localhost or an address of this
machine with --allowed-host.

What must not be forgotten (emergency stop, holds, targets, tasks) and the logs
are kept in a folder per robot; the greeting says where. After a restart nothing
moves before you ask for it. To forget, stop the service and delete the folder.

Where the robot file has a block `devices`, this is the supervisor: it commands
the nodes of the devices over the link, and itself the others. Start each device
by: pilothouse device NAME MODEL --robot FILE

With --backend ros2, the nodes are the ROS 2 nodes of the domain ROS_DOMAIN_ID.
Source setup.bash of the ROS 2 distribution first. ROS 2 participants in that
domain need no token.

exit code: 0 ended by a signal; 1 failed, or a file is invalid;
           2 the environment is invalid, or a file cannot be read;
           64 invalid options;
           130 ended by a second Ctrl-C
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "model", nargs="?", type=Path, metavar="MODEL", help="model file; default: an example"
    )
    parser.add_argument("--robot", type=Path, metavar="FILE", help="robot file: settings")
    add_service_options(
        parser,
        data="~/.local/state/pilothouse/NAME, where NAME is that of the robot file or of the model",
    )


def add_service_options(parser: argparse.ArgumentParser, data: str) -> None:
    """Add the options that every service has, of a supervisor or of a device.

    Args:
        parser: Of the command.
        data: The usual folder for what survives a restart, in words.
    """
    parser.add_argument(
        "--data",
        default=USUAL,
        metavar="DIR",
        help=f"folder for what survives a restart; :memory: keeps nothing; default: {data}",
    )
    parser.add_argument(
        "--backend",
        choices=("simulated", "ros2"),
        help="how nodes are reached; default: as in the robot file, else simulated",
    )
    _add_network(parser)
    _add_link(parser)
    parser.add_argument(
        "--mock-signals", action="store_true", help="publish mock values of the five signals"
    )
    parser.add_argument(
        "--format",
        default="text",
        choices=("text", "json"),
        help="of the greeting; json: {url, version, model, data, token_needed, simulated, ...}",
    )
    parser.add_argument(
        "--log-level", default="info", choices=("debug", "info", "warning", "error")
    )


def _add_link(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--link",
        action="append",
        default=[],
        metavar="ENDPOINT",
        help="where this computer listens for the others of the robot, such as quic/10.0.0.2:7447; "
        "can be repeated; default: as in the robot file",
    )
    parser.add_argument(
        "--insecure-link",
        action="store_true",
        help="link computers over a network without certificates: everybody there can command them",
    )


def _add_network(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--host", default="127.0.0.1", help="address to listen on; default: %(default)s"
    )
    parser.add_argument(
        "--port", default=8000, type=port, help="default: %(default)s; 0: any free port, printed"
    )
    parser.add_argument(
        "--anonymous", action="store_true", help="allow everybody who can reach --host"
    )
    parser.add_argument(
        "--allowed-host",
        action="append",
        default=[],
        metavar="NAME",
        help="further host name under which the service is reached; can be repeated",
    )
    parser.add_argument(
        "--allowed-origin",
        action="append",
        default=[],
        metavar="ORIGIN",
        help="page of another origin, such as https://grafana.example, that may read and, with the "
        "token, write; can be repeated",
    )


def _run(options: argparse.Namespace) -> int:
    from api.serving.serving import serve

    return serve(serve_options(options))


def serve_options(options: argparse.Namespace) -> "ServeOptions":
    """Return what the options of a service say; those of a device besides `device`."""
    from api.serving.composition import ServeOptions

    return ServeOptions(
        model=options.model,
        robot=options.robot,
        backend=options.backend,
        host=options.host,
        port=options.port,
        anonymous=options.anonymous,
        mock_signals=options.mock_signals,
        allowed_hosts=tuple(options.allowed_host),
        allowed_origins=tuple(options.allowed_origin),
        log_level=options.log_level,
        form=options.format,
        data=options.data,
        link=tuple(options.link),
        insecure_link=options.insecure_link,
    )


COMMAND = Command("serve", "run the service", _TEXT, _add_options, _run)
