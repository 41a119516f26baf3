"""`pilothouse serve`: run the service."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command
from api.cli.commands.service_options import add_service_options, serve_options

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


def _run(options: argparse.Namespace) -> int:
    from api.serving.serving import serve

    return serve(serve_options(options))


COMMAND = Command("serve", "run the service", _TEXT, _add_options, _run)
