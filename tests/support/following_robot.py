"""A supervisor in virtual time, one device of which decides about a reaction."""

from domain.commands import AskParameters, AskTransition
from domain.computers import ComputerName
from domain.inputs import ReactionReport
from domain.reaction_terms import ReactionState
from domain.state_and_mode import PartName, StateAndMode
from domain.supervision import SupervisionSettings
from service.files.model_file import read_model
from tests.support.good import GOOD
from tests.support.reacting_robot import FLAGS, flag_signals, reacting_text
from tests.support.restarting_robot import RestartingRobot

BASE = ComputerName("base")
DRIVE = PartName("drive")
CALM = 'CALM: {when: "a", action: mode, target: active.SLOW}'


class FollowingRobot(RestartingRobot):
    """A carrier in FAST, of which a device owns the drive and decides about its one reaction."""

    def __init__(self, of_drive: str = CALM, *reactions: str) -> None:
        name, signals = of_drive.partition(":")[0], flag_signals()
        text = reacting_text(*reactions, of_drive=of_drive)
        settings = SupervisionSettings(signals, reactions_of_devices={name: BASE})
        super().__init__(read_model(text, signals).model, settings)
        self.name = name
        self.read(**GOOD, **dict.fromkeys(FLAGS, False))
        self.ask_mode("carrier", "FAST")
        self.advance(1)
        self.commands.clear()

    def hear(self, state: str) -> None:
        """Let the device tell how its reaction stands."""
        self.give(ReactionReport(DRIVE, self.name, ReactionState(state)))
        self.advance(0)

    def slow_down(self) -> None:
        """Let the device do what its reaction does."""
        self.nodes.handle(AskParameters(0, DRIVE, {"speed": 0.2}), self.now)
        self.advance(1)

    def target(self, part: str = "drive") -> str:
        """Return the target in force, with who set it."""
        pursued = self.core.part(PartName(part)).effective_target
        assert pursued is not None
        label = StateAndMode(pursued.state, pursued.mode).label
        return f"{label} by {pursued.because} {pursued.reaction or ''}".strip()

    @property
    def asked(self) -> list[str]:
        """Return what nodes were asked to do."""
        return [
            type(command).__name__
            for command in self.commands
            if isinstance(command, AskTransition | AskParameters)
        ]
