"""Options that every service has, that of a supervisor or of a device."""

import argparse
from typing import TYPE_CHECKING

from api.cli.commands.command import port
from api.serving.data_folder import USUAL

if TYPE_CHECKING:
    # When the command runs, and not for `--help`: it brings the whole service.
    from api.serving.composition import ServeOptions


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
