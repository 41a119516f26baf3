"""Robots whose model has reactions, and what a story of them needs."""

from domain.actor import Actor
from domain.commands import AskFacts
from domain.errors import BlockedError
from domain.findings import Blocker
from domain.health.signals import SignalKind, SignalSettings, SignalSpec, default_signals
from domain.inputs import (
    AcknowledgeReactionRequest,
    ArmRequest,
    CancelTaskRequest,
    ModeRequest,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.reaction_terms import Arm
from domain.reactions.reaction_view import ReactionView
from domain.state_and_mode import PartName, StateAndMode
from domain.supervision import SupervisionSettings
from service.files.model_file import read_model
from tests.support.good import GOOD
from tests.support.restarting_robot import RestartingRobot

FLAGS = ("a", "b", "c")
"""Signals that conditions name; nothing but reactions follows from them."""

MODEL = """\
carrier:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {lidar: active, drive: active}
      FAST: {drive: active.FAST}
      SLOW: {drive: active.SLOW}
      CRAWL: {drive: active.CRAWL}
%s
lidar: {ros__parameters: {type: node%s}}
drive:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.5}}
      FAST: {ros__parameters: {speed: 0.9}}
      SLOW: {ros__parameters: {speed: 0.2}}
      CRAWL: {ros__parameters: {speed: 0.1}}
%s
"""

LIMP = 'LIMP: {when: "a", action: mode, target: active.SLOW}'
REST = 'REST: {when: "b", action: state, target: inactive}'
HALT = 'HALT: {when: "c", action: hold}'


def flag_signals() -> tuple[SignalSettings, ...]:
    """Return signals of which each reading holds until the next one."""
    flags = [SignalSettings(SignalSpec(name, SignalKind.BOOLEAN), stale_after=0) for name in FLAGS]
    return (*default_signals(), *flags)


def reacting_text(
    *reactions: str,
    settings: str = "",
    of_lidar: str = "",
    of_drive: str = "",
    drive_settings: str = "",
) -> str:
    """Return the file of a carrier with a lidar and a drive.

    Args:
        reactions: Of the carrier, each as a line of YAML.
        settings: Its `mode_settings`, as a line of YAML.
        of_lidar: The one reaction of the lidar.
        of_drive: The one reaction of the drive.
        drive_settings: The `mode_settings` of the drive.
    """
    own = [f"    mode_settings: {settings}"] if settings else []
    own += ["    reactions:", *(f"      {line}" for line in reactions)] if reactions else []
    lidar = f", reactions: {{{of_lidar}}}" if of_lidar else ""
    blocks = [f"    reactions: {{{of_drive}}}"] if of_drive else []
    blocks += [f"    mode_settings: {drive_settings}"] if drive_settings else []
    drive = "\n".join(blocks)
    return MODEL % ("\n".join(own), lidar, drive)


class ReactingRobot(RestartingRobot):
    """A carrier that is in FAST, unless it is told otherwise."""

    def __init__(
        self,
        *reactions: str,
        settings: str = "",
        of_lidar: str = "",
        of_drive: str = "",
        drive_settings: str = "",
        asked: bool = True,
        calm: bool = True,
    ) -> None:
        """Begin with good readings.

        Args:
            reactions: Of the carrier; for this and the next ones see `reacting_text`.
            settings: Of its modes.
            of_lidar: The one reaction of the lidar.
            of_drive: The one reaction of the drive.
            drive_settings: Of the modes of the drive.
            asked: Whether it is asked for FAST.
            calm: Whether all flags are false from the start; else they were never seen.
        """
        text = reacting_text(
            *reactions,
            settings=settings,
            of_lidar=of_lidar,
            of_drive=of_drive,
            drive_settings=drive_settings,
        )
        signals = flag_signals()
        super().__init__(read_model(text, signals).model, SupervisionSettings(signals))
        self.read(**GOOD)
        if calm:
            self.read(**dict.fromkeys(FLAGS, False))
        if asked:
            self.ask_mode("carrier", "FAST")
            self.advance(1)
            assert self.actual("carrier") == "active.FAST"

    def see(self, wait_s: float = 1.0, **flags: bool) -> "ReactingRobot":
        """Hand in what is so, and let that take effect."""
        self.read(**GOOD, **flags)
        if wait_s:
            self.advance(wait_s)
        return self

    def wait(self, duration_s: float) -> "ReactingRobot":
        """Let time pass, with good readings twice a second."""
        for _ in range(round(duration_s * 2)):
            self.read(**GOOD)
            self.advance(0.5)
        return self

    def come_back(self, down_s: float = 1.0) -> "ReactingRobot":
        """Kill the service, and start it again; it asks all nodes what they are in."""
        self.restart(down_s)
        for node in self.model.nodes:
            self.nodes.handle(AskFacts(0, node), self.now)
        self.advance(0)
        return self

    # --- requests --------------------------------------------------------------------------------

    def arm(self, reaction: str, arm: str, part: str = "carrier") -> None:
        """Arm a reaction."""
        actor = Actor("operator")
        self.give(ArmRequest(PartName(part), reaction, Arm(arm), "test", actor))

    def acknowledge_reaction(self, reaction: str, part: str = "carrier") -> None:
        """Say that somebody has seen what a reaction did."""
        self.give(AcknowledgeReactionRequest(PartName(part), reaction, Actor("operator")))

    def refusal_of(self, part: str, mode: str) -> Blocker:
        """Return the first reason for which a mode is refused now."""
        try:
            self.give(ModeRequest(PartName(part), mode))
        except BlockedError as refusal:
            return refusal.blockers[0]
        raise AssertionError(f"{mode} of {part} was not refused")

    def rest(self, part: str, transition: str = "deactivate", wait_s: float = 1.0) -> None:
        """Bring a part to rest."""
        self.give(TransitionRequest(PartName(part), Transition(transition)))
        self.advance(wait_s)

    def drop_task(self) -> None:
        """Cancel the task."""
        self.give(CancelTaskRequest())

    # --- what is seen ----------------------------------------------------------------------------

    def target(self, part: str = "carrier") -> str:
        """Return the target in force, with who set it, such as `active.SLOW by reaction LIMP`."""
        pursued = self.core.part(PartName(part)).effective_target
        if pursued is None:
            return "none"
        label = StateAndMode(pursued.state, pursued.mode).label
        setter = f"{pursued.because} {pursued.reaction or pursued.rule or ''}".strip()
        return label if pursued.because == "requested" else f"{label} by {setter}"

    def reaction(self, name: str, part: str = "carrier") -> ReactionView:
        """Return a reaction."""
        return self.core.reaction_of(PartName(part), name)

    def state(self, name: str, part: str = "carrier") -> str:
        """Return how a reaction stands."""
        return str(self.reaction(name, part).state)

    def why(self, name: str, part: str = "carrier") -> list[str]:
        """Return what is shown as the reason of that."""
        return [blocker.message for blocker in self.reaction(name, part).blockers]

    def told(self, reaction: str) -> list[str]:
        """Return the kinds of all events about a reaction, without those of requests."""
        kinds = ("acting", "ended", "would_act", "overruled", "exhausted")
        return [
            event.kind.removeprefix("reaction.")
            for event in self.events
            if event.data.get("reaction") == reaction
            and event.kind.removeprefix("reaction.") in kinds
        ]

    @property
    def holds(self) -> list[str]:
        """Return the holds of reactions."""
        return [owner for owner in self.core.driving.holds if owner.startswith("reaction:")]
