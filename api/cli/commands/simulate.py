"""`pilothouse simulate`: run a scenario in virtual time."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command

_TEXT = """\
Run a scenario in virtual time, with the code that supervises a real robot, and
compare the results with what the scenario expects. It needs no service and
changes nothing real.

A scenario is YAML or JSON: the body of POST /simulations. In addition it can
name model_file, robot_file and task: {file: track.csv}, relative to its path.

  title: The battery runs low on the way
  until_s: 9
  robot: {signals: {stale_after_s: 0}}
  steps:
    - {t_s: 0, reading: {battery_level: 1.0}}
    - {t_s: 1, task: {file: track.csv, controller: stanley, heading: deg}}
    - {t_s: 4, reading: {battery_level: 0.4}}
    - {t_s: 4, expect: {system_state: {state: ERROR, errors: [BATTERY_LOW]}}}
    - {t_s: 9, expect: {vehicle: {speed_mps: 0}, events: {task.paused: 1}}}

expect lists the relevant members of a sample, last_task (also after it has
ended) and the number of events by kind. A number can be {above: 1}, {below: 1}
or {at_least: 1, at_most: 2}; a state with its mode is active.FAST.
A rejected step fails the scenario, unless it has refused: true.

exit code: 0 as expected; 1 not as expected, or a step was rejected;
           2 a file is invalid or cannot be read
"""


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "scenario", metavar="SCENARIO", help="scenario file; - reads standard input"
    )
    parser.add_argument(
        "--format", default="text", choices=("text", "json"), help="json: the complete result"
    )
    parser.add_argument(
        "--robot", type=Path, metavar="FILE", help="replaces the robot file of the scenario"
    )
    parser.add_argument(
        "--model", type=Path, metavar="FILE", help="replaces the model file of the scenario"
    )


def _run(options: argparse.Namespace) -> int:
    from api.cli.scenario_run import simulate
    from service.files.model_file import EXAMPLE

    return simulate(options.scenario, options.format, EXAMPLE, options.model, options.robot)


COMMAND = Command("simulate", "run a scenario in virtual time", _TEXT, _add_options, _run)
