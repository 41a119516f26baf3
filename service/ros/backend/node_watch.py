"""One node of the robot: its last known state, and the requests to it.

ROS 2 latches neither states nor parameters, and published messages can get lost. So all facts of a
node are queried when it appears, and again whenever a message contradicts what is known of it.
"""

from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Any, TypeAlias

from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.errors import InvalidValueError
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters, ParameterValue
from domain.parts.system_model import NodeModel
from domain.timebase import Duration, Instant, seconds
from service.clock import Clock
from service.ros.backend.node_services import NodeServices, begins, holds_all
from service.ros.backend.retries import Seen, call_with_retries

LOOK_PERIOD: Duration = seconds(1.0)
"""Period of the queries of each node."""
MOST_COMMANDS = 16
"""At most this many commands to one node wait for an answer; further ones are rejected."""
_MISSES = 2
"""After this many queries in a row without an answer a node is unreachable."""
_BEATS_FOR: Duration = seconds(4.5)
"""A node with a heartbeat is not polled for this long after its last message."""
_STATE_FOLLOWS: Duration = seconds(0.2)
_PARAMETERS_FOLLOW: Duration = seconds(0.5)
"""Time for a report to follow an answer; without one, the node is queried."""
_TRIES = 3

NodeMessage: TypeAlias = NodeReport | NodeAnswer
Work: TypeAlias = Callable[[], Coroutine[Any, Any, None]]


@dataclass(slots=True)
class _SentCommands:
    """What was asked of the node and is not done yet."""

    open: dict[int, AskTransition | AskParameters] = field(default_factory=dict)
    """Commands without an answer, or whose effect was not reported yet, by request."""
    newest: int | None = None
    """Request of the latest command: an older one must not be repeated after it."""
    started: set[int] = field(default_factory=set)
    """Requests of transitions that the node reported as started."""


class NodeWatch:
    """The known state of one node, and the commands to it.

    One class, since each half needs the other: a missed answer, a contradicting report and a
    command without visible effect all lead to the same query, and share its timing.
    All methods return at once. The first report is that the node is unreachable.
    """

    def __init__(
        self,
        node: NodeModel,
        services: NodeServices,
        clock: Clock,
        deliver: Callable[[NodeMessage], None],
        start: Callable[[Work], bool],
    ) -> None:
        """Prepare; nothing is queried before `look`.

        Args:
            node: Its name, and the parameters of its modes.
            services: The services of the node.
            clock: Of the service.
            deliver: Gets the reports and answers of the node.
            start: Runs a coroutine function as a task; False: not possible before the start or
                after the end.
        """
        self._name = node.name
        # A dictionary and not a set, since it keeps the order.
        self._names = {name: None for mode in node.modes.values() for name in mode}
        self._services = services
        self._clock = clock
        self._deliver = deliver
        self._start = start
        self._is_there = False
        self._has_lifecycle = True
        self._state: LifecycleState | None = None
        self._parameters: dict[str, ParameterValue] | None = None
        """None: they could not be queried yet."""
        self._heard = 0
        """Number of reports of its state."""
        self._heard_at: Instant = 0
        self._news: dict[str, ParameterValue] = {}
        """Parameters that the node reported since they were last queried."""
        self._processes = 0
        """Number of processes of the node in the graph at the last query."""
        self._known_since: Instant | None = None
        """Time since which the graph knows one of its services."""
        self._beats = False
        self._misses = 0
        self._looking = False
        self._wants_all = False
        """Whether the next query is for all facts, and not only for the state."""
        self._sent = _SentCommands()
        self._deliver(NodeReport(self._name, reachable=False))

    # --- messages of the node --------------------------------------------------------------------

    def take_transition(self, start: LifecycleState, goal: LifecycleState) -> None:
        """Take a report that the node went from one state to another."""
        self._note_word()
        self._heard += 1
        for request, command in tuple(self._sent.open.items()):
            if request not in self._sent.started and begins(command, start, goal):
                self._sent.started.add(request)
                self._answer(command, True)
        if not self._is_there:
            # Its answer to the pending query will report everything.
            return
        if start is not self._state:
            # A message was lost or is late, or the process is another one: query the node.
            self._ask_all()
        else:
            self._state = goal
            self._deliver(NodeReport(self._name, state=goal))

    def take_parameters(self, values: Parameters) -> None:
        """Take a report that parameters of the node were set."""
        self._note_word()
        self._news.update(values)
        if self._is_there:
            if self._parameters is not None:
                self._parameters.update(values)
            self._deliver(NodeReport(self._name, parameters=MappingProxyType(dict(values))))

    def take_heartbeat(self, beats: bool) -> None:
        """Take whether any process of the node is alive."""
        self._beats = beats
        if beats:
            # A restarted process appears before the loss of the old one is noticed.
            self._ask_all()
        else:
            self._lose()

    def _note_word(self) -> None:
        self._misses = 0
        self._heard_at = self._clock.now()

    # --- whether it is reachable -----------------------------------------------------------------

    def look(self) -> None:
        """Query the node, or look for it; to be called every `LOOK_PERIOD`."""
        if self._is_there:
            if not self._has_lifecycle and self._services.has_lifecycle:
                self._has_lifecycle = self._wants_all = True
            if self._parameters is None and self._services.has_parameters:
                self._wants_all = True
            silent_for = self._clock.now() - self._heard_at
            if self._beats and silent_for < _BEATS_FOR and not self._wants_all:
                return
        self._look_soon()

    def _ask_all(self) -> None:
        self._wants_all = True
        self._look_soon()

    def _look_soon(self) -> None:
        """Start a query, unless one is running or the node cannot be queried."""
        if not self._looking and (self._is_there or self._can_be_asked()):
            self._looking = self._start(self._look)

    def _can_be_asked(self) -> bool:
        """Tell whether the graph knows enough services of the node.

        They are discovered one after the other, and a plain node does not have all of them; so the
        missing ones are waited for, for one `LOOK_PERIOD`.
        """
        now = self._clock.now()
        if not (self._services.has_lifecycle or self._services.has_parameters):
            self._known_since = None
            return False
        if self._known_since is None:
            self._known_since = now
        return self._services.are_complete or now - self._known_since >= LOOK_PERIOD

    async def _look(self) -> None:
        try:
            if self._is_there and not self._wants_all:
                self._wants_all = not await self._is_as_known() or self._wants_all
            for _ in range(_TRIES):
                if self._is_there and not self._wants_all:
                    break
                await self._learn()
        except TimeoutError:
            self._miss()
        finally:
            self._looking = False

    async def _is_as_known(self) -> bool:
        """Query the facts that show whether a report was missed.

        Raises:
            TimeoutError: The node does not answer.
        """
        heard = self._heard
        if self._has_lifecycle:
            # The answer may be older than a report that came meanwhile.
            is_same = await self._ask_state() is self._state or heard != self._heard
            return is_same and not self._was_restarted()
        values = await self._ask_parameters()
        return values is None or holds_all(self._parameters, values)

    def _was_restarted(self) -> bool:
        """Tell whether the node was restarted, since it may be in the same state as before."""
        known, self._processes = self._processes, self._services.processes
        return self._processes > known

    async def _learn(self) -> None:
        """Query everything and deliver it in one report, unless a newer report came meanwhile.

        Raises:
            TimeoutError: The node does not answer.
        """
        self._wants_all, heard = False, self._heard
        processes = self._services.processes
        has_lifecycle = self._services.has_lifecycle
        if self._is_there:
            has_lifecycle = self._has_lifecycle
        try:
            state = await self._ask_state() if has_lifecycle else None
            values = await self._ask_parameters()
        except TimeoutError:
            self._wants_all = True
            raise
        if self._wants_all or heard != self._heard:
            self._wants_all = True
            return
        self._is_there, self._has_lifecycle = True, has_lifecycle
        self._state, self._parameters, self._processes = state, values, processes
        self._heard += 1
        report = NodeReport(
            self._name,
            state=state,
            parameters=None if values is None else MappingProxyType(dict(values)),
            reachable=True,
            has_lifecycle=has_lifecycle,
        )
        self._deliver(report)

    async def _ask_state(self) -> LifecycleState:
        state = await self._services.state()
        self._note_word()
        return state

    async def _ask_parameters(self) -> dict[str, ParameterValue] | None:
        """Return the parameters of its modes that are set; None: it has no parameter service.

        Reports that come meanwhile are newer, and replace what was queried.
        """
        if not self._services.has_parameters:
            return None
        self._news = {}
        values = await self._services.parameters(self._names)
        self._note_word()
        return values | self._news

    def _miss(self) -> None:
        """Count a query without an answer."""
        if self._beats and self._is_in_transition():
            # The process is alive, and its thread is busy with a callback.
            return
        self._misses += 1
        if self._misses >= _MISSES:
            self._lose()

    def _is_in_transition(self) -> bool:
        moves = self._state is not None and not self._state.is_primary
        return moves or self._is_told_to_move()

    def _is_told_to_move(self) -> bool:
        return any(isinstance(command, AskTransition) for command in self._sent.open.values())

    def _lose(self) -> None:
        if self._is_there:
            self._is_there, self._misses = False, 0
            self._deliver(NodeReport(self._name, reachable=False))

    # --- commands to it --------------------------------------------------------------------------

    def send(self, command: NodeCommand) -> None:
        """Send a command; if the node does not respond, there is no answer."""
        if isinstance(command, AskFacts):
            self._ask_all()
            return
        if reason := self._why_not(command):
            self._answer(command, False, reason)
            return
        work: Work
        if isinstance(command, AskTransition):
            work = partial(self._change_state, command)
        else:
            work = partial(self._set_parameters, command)
        self._sent.open[command.request] = command
        self._sent.newest = command.request
        self._start(work)

    def _why_not(self, command: AskTransition | AskParameters) -> str:
        """Return why a command is not sent; empty: it is sent."""
        if not self._is_there:
            return "not reachable"
        if isinstance(command, AskTransition) and not self._has_lifecycle:
            return "the node has no lifecycle"
        if len(self._sent.open) >= MOST_COMMANDS:
            return f"{MOST_COMMANDS} commands already wait for an answer"
        return ""

    def _answer(
        self, command: AskTransition | AskParameters, accepted: bool, reason: str = ""
    ) -> None:
        self._deliver(NodeAnswer(command.request, self._name, accepted, reason))

    async def _change_state(self, ask: AskTransition) -> None:
        """Request a transition, and make sure that its end is reported.

        The node responds when its callback has ended. If it reports the start of the transition
        earlier, the command is answered then, see `take_transition`.
        """
        heard = self._heard
        try:
            start = self._state
            done = await call_with_retries(
                partial(self._services.change_state, ask.transition, start),
                partial(self._see_transition, ask, start),
                True,
                self._clock,
            )
            self._note_word()
            if ask.request not in self._sent.started:
                self._answer(ask, done, "" if done else await self._why_refused(ask))
            await self._clock.sleep_until(self._clock.now() + _STATE_FOLLOWS)
        except TimeoutError:
            return
        finally:
            del self._sent.open[ask.request]
            self._sent.started.discard(ask.request)
        rests = self._state is not None and self._state.is_primary
        if not self._is_told_to_move() and (heard == self._heard or not rests):
            self._ask_all()

    async def _see_transition(self, ask: AskTransition, start: LifecycleState | None) -> Seen:
        """Find out what became of a transition; activate is never requested twice.

        An e-stop may have been pressed meanwhile, which is not known here.
        """
        if ask.request in self._sent.started:
            return Seen.UNCLEAR
        state = await self._ask_state()
        if state is ask.transition.goal:
            return Seen.DONE
        may_be_sent = ask.transition is not Transition.ACTIVATE and ask.request == self._sent.newest
        return Seen.LOST if state is start and may_be_sent else Seen.UNCLEAR

    async def _see_parameters(self, ask: AskParameters) -> Seen:
        values = await self._services.parameters(ask.values)
        self._note_word()
        if holds_all(values, ask.values):
            return Seen.DONE
        return Seen.LOST if ask.request == self._sent.newest else Seen.UNCLEAR

    async def _why_refused(self, ask: AskTransition) -> str:
        try:
            offered = await self._services.available_transitions()
        except TimeoutError:
            return f"the node rejected {ask.transition}"
        if ask.transition in offered:
            return f"the node tried to {ask.transition} and went back"
        return f"the node rejected {ask.transition}; it offers {', '.join(offered) or 'nothing'}"

    async def _set_parameters(self, ask: AskParameters) -> None:
        """Set parameters, and make sure that they are reported."""
        try:
            reason = await call_with_retries(
                partial(self._services.set_parameters, ask.values, self._parameters or {}),
                partial(self._see_parameters, ask),
                "",
                self._clock,
            )
            self._note_word()
            self._answer(ask, not reason, reason)
            if reason:
                return
            self._names.update(dict.fromkeys(ask.values))
            await self._clock.sleep_until(self._clock.now() + _PARAMETERS_FOLLOW)
            if not holds_all(self._parameters, ask.values):
                self._ask_all()
        except TimeoutError:
            return
        except InvalidValueError as error:
            self._answer(ask, False, error.message)
        finally:
            del self._sent.open[ask.request]
