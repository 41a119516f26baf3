"""`pilothouse monitor`: watch a robot in a terminal."""

import argparse

from api.cli.commands.command import Command, add_url, answered

_TEXT = """\
Watch a robot in this terminal until q or Ctrl-C: its state with reasons, its
systems and nodes with their targets, signals and task. Nothing is changed.

Each part has a line, as in the mode monitor of system_modes: target and actual
of its state, target and actual of its mode; (*) marks inferred values. What
else there is to say about parts is beneath. Lines that need attention are
marked:
  ! deviates from its target       > a change is running
  x a node is not reachable
On a short screen, marked lines come first, and the others are counted.
If the connection is lost, the monitor says so and reconnects.

  pilothouse monitor                          the service on this machine
  pilothouse monitor http://robot.local:8000  another service
  ssh -t robot pilothouse monitor             over ssh; -t allocates a terminal
  pilothouse monitor > robot.log              one snapshot per change
  pilothouse monitor --once                   one snapshot, then exit
  pilothouse monitor --once --format json | jq .system_state.state
  pilothouse monitor --ros2 actuation.yaml    without a service, over ROS 2

With --ros2, no service is needed: states and parameters are asked of the nodes
of the model, as the service does, and targets are those that the service, or
the mode manager of system_modes, announces on */transition_request_info and
*/mode_request_info. Without these, a system shows the state that its parts
have in common. Only systems and nodes are shown. Run it in the ROS_DOMAIN_ID
and with the message packages of the robot.

If the output is not a terminal, it is plain text, with a new snapshot whenever
a state, mode, target, hold or the task status changes. --format json writes
one JSON object per such change, also to a terminal:
{at, system_state, parts, signals, task, vehicle, emergency_stop, holds};
with --ros2 {at, parts}.

environment:
  PILOTHOUSE_URL         URL of the service, if none is given
  PILOTHOUSE_TOKEN       token
  PILOTHOUSE_TOKEN_FILE  file with the token
  ROS_DOMAIN_ID          with --ros2: the ROS domain; default: 0
  NO_COLOR               no colours
  COLUMNS                width without a terminal; default: 80

exit code: 0 ended by q or Ctrl-C, or --once has a snapshot, also of a robot in
           ERROR; 1 rejected, as without a valid token; 2 no answer, with
           --ros2 also: invalid model, no ROS 2, or --once hears no node
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    source = parser.add_mutually_exclusive_group()
    source.add_argument("address", nargs="?", metavar="URL", help="URL of the service; as --url")
    source.add_argument(
        "--ros2", metavar="MODEL", help="model file; watch its parts in ROS 2, without a service"
    )
    add_url(parser)
    parser.add_argument("--once", action="store_true", help="show one snapshot, then exit")
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="json: as in the HTTP interface"
    )


def _run(options: argparse.Namespace) -> int:
    if options.ros2 is not None:
        from api.cli.ros_monitor import ros_monitor

        return answered(lambda: ros_monitor(options.ros2, options.format, once=options.once))
    from api.cli.monitor.monitor import monitor

    return answered(
        lambda: monitor(options.address or options.url, options.format, once=options.once)
    )


COMMAND = Command("monitor", "watch a robot in a terminal", _TEXT, _add_options, _run)
