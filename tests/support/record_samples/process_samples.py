"""Values of all that is said and kept of the processes of nodes."""

from collections.abc import Mapping

from domain.actor import Actor
from domain.commands import StartProcess, StopProcess
from domain.events.processes import (
    ProcessEnded,
    ProcessGivenUp,
    ProcessReady,
    ProcessRequested,
    ProcessStarted,
    ProcessWaits,
)
from domain.kept import KeptProcess
from domain.process_terms import ProcessAction, ProcessExit, ProcessReport, ProcessRequest
from domain.state_and_mode import PartName

_ARM = PartName("left/arm")
_ENDED = "the process of left/arm ended: exit code 1"

PROCESSES: Mapping[str, tuple[object, ...]] = {
    "process_report": (
        ProcessReport(node=_ARM),
        ProcessReport(node=_ARM, pid=4711),
        ProcessReport(node=_ARM, exit=ProcessExit(code=1)),
        ProcessReport(node=_ARM, exit=ProcessExit(signal="SIGSEGV")),
        ProcessReport(node=_ARM, exit=ProcessExit(reason="it could not be started")),
    ),
    "process_request": (
        ProcessRequest(node=_ARM, action=ProcessAction.RESTART),
        ProcessRequest(
            node=_ARM,
            action=ProcessAction.STOP,
            actor=Actor(name="ada", way="http", address="10.0.0.7"),
        ),
    ),
    "start_process": (StartProcess(node=_ARM),),
    "stop_process": (StopProcess(node=_ARM),),
    "kept_process": (
        KeptProcess(node=_ARM, is_stopped=True),
        KeptProcess(node=_ARM, given_up=_ENDED, ages=(2_000_000_000, 0)),
    ),
    "process.started": (ProcessStarted(node=_ARM, pid=4711),),
    "process.ended": (
        ProcessEnded(node=_ARM, code=1, signal="", reason="exit code 1"),
        ProcessEnded(node=_ARM, code=None, signal="SIGSEGV", reason="ended by SIGSEGV"),
    ),
    "process.ready": (ProcessReady(node=_ARM),),
    "process.requested": (ProcessRequested(node=_ARM, action=ProcessAction.START),),
    "process.waits": (ProcessWaits(node=_ARM, for_s=0.5, starts_left=3),),
    "process.given_up": (ProcessGivenUp(node=_ARM, starts=5, within_s=60.0),),
}
