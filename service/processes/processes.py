"""Runs the processes of nodes: one task each, started and stopped as the core says."""

import asyncio
from collections.abc import Mapping

from domain.commands import ProcessCommand, StartProcess
from domain.process_terms import ProcessExit, ProcessReport
from domain.state_and_mode import PartName
from service.ports import Deliver, ProcessOutput
from service.processes.guard import Guard
from service.processes.output_tail import OutputTail
from service.processes.program import Program, ProgramSettings
from service.running import run_forever


class LocalProcesses:
    """A `ProcessRunner`: programs on this computer."""

    def __init__(self, programs: Mapping[PartName, ProgramSettings]) -> None:
        """Prepare; nothing is started before the core says so."""
        self._guard = Guard()
        self._runs = {node: _Run(node, own, self._guard) for node, own in programs.items()}

    async def run(self, deliver: Deliver) -> None:
        """Start and stop programs until cancelled; then end all that run, side by side."""
        for node in self._runs:
            deliver(ProcessReport(node))
        try:
            await run_forever(
                {f"process of {node}": run.run(deliver) for node, run in self._runs.items()}
            )
        finally:
            await self._guard.close()

    def send(self, command: ProcessCommand, /) -> None:
        """Start or stop a program."""
        run = self._runs.get(command.node)
        if run is not None:
            run.ask(is_wanted=isinstance(command, StartProcess))

    def output(self, node: PartName, /) -> ProcessOutput:
        """Return what the program of a node printed."""
        return self._runs[node].output()


class _Run:
    """The program of one node, which runs now and then."""

    def __init__(self, node: PartName, settings: ProgramSettings, guard: Guard) -> None:
        self._node = node
        self._settings = settings
        self._guard = guard
        self._is_wanted = False
        self._asked = asyncio.Event()
        self._tail = OutputTail()
        self._ended = OutputTail()

    def ask(self, *, is_wanted: bool) -> None:
        """Start the program, or stop it."""
        self._is_wanted = is_wanted
        self._asked.set()

    def output(self) -> ProcessOutput:
        return ProcessOutput(self._tail.lines(), self._ended.lines())

    async def run(self, deliver: Deliver) -> None:
        """Run the program whenever it is wanted; if it ends by itself, until it is wanted anew."""
        while True:
            await self._asked.wait()
            self._asked.clear()
            if self._is_wanted:
                end = await self._run_once(deliver)
                self._is_wanted = False
                self._ended, self._tail = self._tail, OutputTail()
                deliver(ProcessReport(self._node, exit=end))

    async def _run_once(self, deliver: Deliver) -> ProcessExit:
        try:
            program = await Program.start(self._settings, self._guard, self._tail)
        except OSError as error:
            return ProcessExit(reason=f"it could not be started: {error.strerror or error}")
        ending = asyncio.create_task(program.ended())
        try:
            deliver(ProcessReport(self._node, program.pid))
            await self._until_unwanted_or(ending)
            return await ending if ending.done() else await _stop(program, ending)
        except BaseException:
            # The service ends: so does the program.
            await _stop(program, ending)
            raise

    async def _until_unwanted_or(self, ending: asyncio.Task[ProcessExit]) -> None:
        while self._is_wanted and not ending.done():
            asked = asyncio.create_task(self._asked.wait())
            try:
                await asyncio.wait([ending, asked], return_when=asyncio.FIRST_COMPLETED)
            finally:
                asked.cancel()
            self._asked.clear()


async def _stop(program: Program, ending: asyncio.Task[ProcessExit]) -> ProcessExit:
    ending.cancel()
    return await program.stop()
