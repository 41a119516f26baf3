"""Connects supervision and navigation.

One input in; commands to nodes, vehicle and, if there is one, an external controller, and events,
out. Whoever drives, a hold stops the vehicle in the same step.
"""

from collections.abc import Sequence

from domain.commands import Command, Drive, PreemptGoal, SendGoal
from domain.controller import ControllerMessage
from domain.external_navigation import ExternalNavigation
from domain.inputs import Input, TimePassed
from domain.navigation import Navigation
from domain.outbox import Outputs
from domain.supervision import Supervision
from domain.timebase import Instant


class Onboard:
    """The core with its navigation.

    At one instant, deadlines of the core come first, then the control step, then the input.
    """

    def __init__(self, core: Supervision, navigation: Navigation | ExternalNavigation) -> None:
        self.core = core
        self.navigation = navigation
        self._untold: list[Outputs] = []
        """Outputs of calls whose input was rejected; returned by the next call."""

    def wake_at(self) -> Instant | None:
        """Return the next instant at which time alone changes something; None: never."""
        core, navigation = self.core.wake_at(), self.navigation.wake_at()
        if core is None or navigation is None:
            return navigation if core is None else core
        return min(core, navigation)

    def handle(self, given: Input, now: Instant) -> Outputs:
        """Handle one input, after everything that was due before it, each at its own time.

        Args:
            given: A fact or a request.
            now: When it arrived; it never decreases.

        Returns:
            Commands, events and changed views; after a rejection, the next call returns them.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        self._let_pass(now)
        self._take(given, now)
        return self._told()

    def take_in(self, given: Input, now: Instant) -> Outputs:
        """Handle one input that is late by our own fault, before what was due before it.

        The next `handle` judges what is due then. Of missed control steps one is made up for, once
        there is a pose that is new enough.

        Args:
            given: A fact or a request.
            now: The current time; it never decreases.

        Returns:
            As `handle`.

        Raises:
            PilothouseError: The input is rejected; it changed nothing.
        """
        self._take(given, now, is_late=True)
        self._let_navigation_act(now, is_late=True)
        return self._told()

    def _told(self) -> Outputs:
        gathered, self._untold = self._untold, []
        return _merged(gathered)

    def _let_pass(self, now: Instant) -> None:
        while (due := self.navigation.wake_at()) is not None and due <= now:
            core_due = self.core.wake_at()
            if core_due is not None and core_due <= due:
                self._take(TimePassed(), due)
            self._let_navigation_act(due)

    def _take(self, given: Input, now: Instant, *, is_late: bool = False) -> None:
        if isinstance(given, ControllerMessage):
            self._take_from_controller(given, now, is_late=is_late)
            return
        outputs = self.core.take_in(given, now) if is_late else self.core.handle(given, now)
        if not outputs.commands:
            self._untold.append(outputs)
            return
        goals = [c for c in outputs.commands if isinstance(c, SendGoal | PreemptGoal)]
        if goals:
            others = tuple(c for c in outputs.commands if not isinstance(c, SendGoal | PreemptGoal))
            outputs = outputs._replace(commands=others)
        self._untold.append(outputs)
        for goal in goals:
            self.navigation.handle(goal, now)
        if goals:
            self._let_navigation_act(now, is_late=is_late)

    def _take_from_controller(
        self, given: ControllerMessage, now: Instant, *, is_late: bool
    ) -> None:
        """Let navigation judge what an external controller says, after what the core has due."""
        self._take(TimePassed(), now, is_late=is_late)
        if isinstance(self.navigation, ExternalNavigation):
            self.navigation.take(given, now)
            self._let_navigation_act(now, is_late=is_late)

    def _let_navigation_act(self, now: Instant, *, is_late: bool = False) -> None:
        act = self.navigation.catch_up if is_late else self.navigation.advance
        for message in act(now):
            # Goals of an external controller leave as commands, like those to the vehicle.
            if isinstance(message, Drive | SendGoal | PreemptGoal):
                self._untold.append(Outputs(commands=(message,)))
            else:
                self._take(message, now, is_late=is_late)


def _merged(parts: Sequence[Outputs]) -> Outputs:
    """Join the outputs of several steps, in order."""
    if len(parts) == 1:
        return parts[0]
    commands: list[Command] = []
    for part in parts:
        commands += part.commands
    return Outputs(
        tuple(commands),
        tuple(event for part in parts for event in part.events),
        next((part.change for part in parts if part.change is not None), None),
        frozenset().union(*(part.parts for part in parts)),
        frozenset().union(*(part.signals for part in parts)),
        frozenset().union(*(part.errors for part in parts)),
        frozenset().union(*(part.reactions for part in parts)),
        any(part.system_state for part in parts),
        next((part.task for part in parts if part.task is not None), None),
        any(part.task_changed for part in parts),
        any(part.vehicle_changed for part in parts),
        tuple(kept for part in parts for kept in part.kept),
        frozenset().union(*(part.devices for part in parts)),
    )
