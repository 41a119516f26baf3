"""`pilothouse simulate`: let a scenario happen in virtual time."""

import argparse
from pathlib import Path

from api.cli.commands.command import Command

_TEXT = """\
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


def _add_options(parser: argparse.ArgumentParser) -> None:
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


def _run(options: argparse.Namespace) -> int:
    from api.cli.scenario_run import simulate
    from api.serving.composition import EXAMPLE

    return simulate(options.scenario, options.format, EXAMPLE, options.model, options.robot)


COMMAND = Command("simulate", "let a scenario happen in virtual time", _TEXT, _add_options, _run)
