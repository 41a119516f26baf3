"""A `ProcessRunner` without processes: a test says what they do."""

import asyncio

from domain.commands import ProcessCommand
from domain.process_terms import ProcessExit, ProcessReport
from domain.state_and_mode import PartName
from service.ports import Deliver, ProcessOutput
from service.supervisor import Supervisor


class ScriptedProcesses:
    """Remembers what it is told, and reports what the test says."""

    def __init__(self, supervisor: Supervisor, node: PartName) -> None:
        self.told: list[ProcessCommand] = []
        self.printed = ProcessOutput((), ())
        self._supervisor = supervisor
        self._node = node
        supervisor.processes = self

    async def run(self, deliver: Deliver) -> None:
        """Say that nothing runs."""
        deliver(ProcessReport(self._node))
        await asyncio.Event().wait()

    def send(self, command: ProcessCommand, /) -> None:
        """Remember a command."""
        self.told.append(command)

    def output(self, _node: PartName, /) -> ProcessOutput:
        """Return what the test says was printed."""
        return self.printed

    def is_ready(self) -> None:
        """Say that nothing runs."""
        self._supervisor.deliver(ProcessReport(self._node))

    def runs(self, pid: int) -> None:
        """Say that the process runs."""
        self._supervisor.deliver(ProcessReport(self._node, pid))

    def ends(self, end: ProcessExit) -> None:
        """Say that it ended."""
        self._supervisor.deliver(ProcessReport(self._node, exit=end))
