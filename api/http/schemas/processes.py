"""The process of a node, and what may be asked of it."""

from pydantic import Field

from api.http.schemas.base import Body, Json, Timestamp, timestamp_or_none
from domain.process_terms import ProcessAction, ProcessExit, ProcessState
from domain.processes.process_view import ProcessView
from domain.state_and_mode import PartName
from service.clock import Clock
from service.ports import ProcessOutput


class ProcessExitJson(Json):
    """How a process ended."""

    code: int | None = Field(description="Exit code; null: a signal ended it, or it never ran")
    signal: str | None = Field(description="Signal that ended it", examples=["SIGSEGV"])
    reason: str = Field(description="In words", examples=["exit code 1"])
    at: Timestamp | None
    output: list[str] = Field(description="The last lines it printed, the newest last")

    @classmethod
    def of(cls, exit_: ProcessExit, at: str | None, output: list[str]) -> "ProcessExitJson":
        """Show how a process ended."""
        return cls(
            code=exit_.code,
            signal=exit_.signal or None,
            reason=exit_.words,
            at=at,
            output=output,
        )


class ProcessJson(Json):
    """The process of a node."""

    node: PartName
    state: ProcessState = Field(
        description="`waiting`: it ended, and is started again after the back-off; `ended`: it is "
        "not; `given_up`: it ended too often; `not_run_here`: the nodes are simulated"
    )
    pid: int | None
    since_at: Timestamp | None = Field(description="Since when it runs")
    next_start_at: Timestamp | None
    starts_left: int = Field(description="Starts that are left within the time of its budget")
    exit: ProcessExitJson | None = Field(description="How it ended last; null: it did not")
    output: list[str] = Field(
        description="The last 200 lines that it printed, stdout and stderr, the newest last"
    )

    @classmethod
    def of(cls, view: ProcessView, output: ProcessOutput, clock: Clock) -> "ProcessJson":
        """Show a process."""
        ended = view.exit
        at = timestamp_or_none(clock, view.exit_at)
        return cls(
            node=view.node,
            state=view.state,
            pid=view.pid,
            since_at=timestamp_or_none(clock, view.since),
            next_start_at=timestamp_or_none(clock, view.next_start),
            starts_left=view.starts_left,
            exit=None if ended is None else ProcessExitJson.of(ended, at, [*output.ended]),
            output=[*output.running],
        )


class ProcessBody(Body):
    """What is asked of the process of a node."""

    action: ProcessAction = Field(
        strict=False,
        description="`start` and `restart` make its whole budget available; one that was stopped "
        "stays so over a restart of the service",
    )
