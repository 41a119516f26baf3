"""The programs that a robot file names."""

from pathlib import Path

from domain.state_and_mode import PartName
from service.files.process_block import ProcessBlock
from service.files.robot_file import RobotSettings
from service.processes.processes import LocalProcesses
from service.processes.program import ProgramSettings


def make_processes(robot: RobotSettings, robot_file: Path | None) -> LocalProcesses | None:
    """Return who runs the programs of nodes; None: the robot file names none.

    Args:
        robot: Settings of the nodes that this computer reaches.
        robot_file: Relative folders are resolved against its folder.
    """
    folder = Path.cwd() if robot_file is None else robot_file.parent.absolute()
    programs = {
        PartName(name): _program(node.process, folder)
        for name, node in robot.nodes.items()
        if node.process is not None
    }
    return LocalProcesses(programs) if programs else None


def _program(block: ProcessBlock, folder: Path) -> ProgramSettings:
    return ProgramSettings(
        tuple(block.command), str(folder / block.cwd), block.environment, block.stop_s
    )
