"""The block `process` of a node in a robot file: the program that is run for it."""

from typing import Annotated, Self, TypeAlias

from pydantic import Field, model_validator

from domain.process_terms import RestartPolicy
from domain.processes.settings import ProcessSettings
from domain.timebase import seconds
from service.files.settings_block import Seconds, SettingsBlock

MAX_ARGUMENTS = 200
MAX_VARIABLES = 200

_WITHOUT_NUL = r"^[^\x00]*$"
_Argument: TypeAlias = Annotated[str, Field(pattern=_WITHOUT_NUL, max_length=4_096)]
_Path: TypeAlias = Annotated[str, Field(pattern=r"^[^\x00]+$", max_length=4_096)]
_Variable: TypeAlias = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,127}$")]
_BackOff: TypeAlias = Annotated[float, Field(ge=0.05, le=3_600, allow_inf_nan=False)]


class BackOffBlock(SettingsBlock):
    """How long to wait before a process is started again, in seconds."""

    first: _BackOff = 0.5
    """After its first end; twice as long after each further one."""
    most: _BackOff = 30.0
    """The longest; a process that has run so long begins with `first` again."""

    @model_validator(mode="after")
    def _grows(self) -> Self:
        if self.first > self.most:
            raise ValueError("first is longer than most")
        return self


class BudgetBlock(SettingsBlock):
    """How often a process may be started, before it is given up until somebody asks."""

    starts: Annotated[int, Field(ge=1, le=1_000)] = 5
    """Starts within `within_s`, those by the service itself included."""
    within_s: Annotated[float, Field(ge=1, le=86_400, allow_inf_nan=False)] = 60.0
    """Time over which they are counted, in seconds; it does not pass while the service is down."""


class ProcessBlock(SettingsBlock):
    """The program of a node: started with the service, watched, started again, ended with it.

    Without effect for a simulated node, and in simulations.
    """

    command: Annotated[list[_Argument], Field(min_length=1, max_length=MAX_ARGUMENTS)]
    """The program and its arguments, one by one: no shell reads them."""
    cwd: _Path = "."
    """Its working directory, relative to the folder of the robot file. Default: that folder."""
    environment: Annotated[dict[_Variable, _Argument], Field(max_length=MAX_VARIABLES)] = Field(
        default_factory=dict
    )
    """Variables of its environment besides those of the service. They are neither shown nor logged,
    and left out of the record."""
    restart: RestartPolicy = Field(RestartPolicy.ON_FAILURE, strict=False)
    """After which ends it is started again: `on_failure` (a signal, or an exit code other than 0),
    `always` or `never`."""
    back_off_s: BackOffBlock = BackOffBlock()
    """How long to wait before that."""
    budget: BudgetBlock = BudgetBlock()
    """How often, before it is given up."""
    stop_s: Annotated[Seconds, Field(le=60)] = 5.0
    """How long it has to end, in seconds: SIGINT first, SIGTERM after half of it, then SIGKILL."""

    @model_validator(mode="after")
    def _names_a_program(self) -> Self:
        if not self.command[0]:
            raise ValueError("the first word of command is the program; it is empty")
        return self

    def to_domain(self) -> ProcessSettings:
        """Return when it is started again, for the core."""
        return ProcessSettings(
            self.restart,
            seconds(self.back_off_s.first),
            seconds(self.back_off_s.most),
            self.budget.starts,
            seconds(self.budget.within_s),
        )
