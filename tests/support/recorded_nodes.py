"""The nodes of the example robot of D4.8, simulated, with what they say and when."""

from collections.abc import Mapping
from itertools import count

from domain.commands import AskFacts, AskParameters, AskTransition
from domain.inputs import NodeAnswer, NodeReport
from domain.lifecycle import LifecycleState, Transition
from domain.parameters import Parameters
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.nodes import NodeMessage, SimulatedNodes
from domain.state_and_mode import PartName
from domain.timebase import Instant, seconds, to_seconds
from tests.support.models import actuation_model


class RecordedNodes:
    """Simulated nodes in virtual time; what they say is kept with its time in seconds."""

    def __init__(
        self,
        settings: Mapping[PartName, NodeSettings] | None = None,
        start: Instant = 0,
        model: SmhModel | None = None,
    ) -> None:
        self.nodes = SimulatedNodes(model or actuation_model(), settings or {}, start)
        self.start = start
        self.now = start
        self._requests = count(1)
        self.heard: list[tuple[float, NodeMessage]] = []

    def pass_time(self, by_s: float) -> list[tuple[float, NodeMessage]]:
        """Let time pass and return what was said in it, waking only when the nodes want it."""
        end = self.now + seconds(by_s)
        said: list[tuple[float, NodeMessage]] = []
        while (at := self.nodes.wake_at()) is not None and at <= end:
            said.extend((to_seconds(at - self.start), m) for m in self.nodes.advance(at))
        self.now = end
        self.heard.extend(said)
        return said

    def ask(self, node: PartName, transition: Transition) -> int:
        """Ask for a transition and return the number of the request."""
        request = next(self._requests)
        self.nodes.handle(AskTransition(request, node, transition), self.now)
        return request

    def ask_parameters(self, node: PartName, values: Parameters) -> int:
        """Ask for parameters to be set and return the number of the request."""
        request = next(self._requests)
        self.nodes.handle(AskParameters(request, node, values), self.now)
        return request

    def ask_facts(self, node: PartName) -> int:
        """Ask for everything there is to say and return the number of the request."""
        request = next(self._requests)
        self.nodes.handle(AskFacts(request, node), self.now)
        return request

    def set_fault(self, node: PartName, fault: Fault | None) -> None:
        """Let something be wrong with a node from now on."""
        self.nodes.set_fault(node, fault, self.now)

    def bring(self, node: PartName, *transitions: Transition) -> None:
        """Lead a node through transitions, each until it is done, and hear what is said."""
        self.pass_time(0.0)
        for transition in transitions:
            self.ask(node, transition)
            self.pass_time(10.0)


def states(said: list[tuple[float, NodeMessage]]) -> list[tuple[float, LifecycleState]]:
    """Return the states that were reported, with their times."""
    return [(t, m.state) for t, m in said if isinstance(m, NodeReport) and m.state is not None]


def answers(said: list[tuple[float, NodeMessage]]) -> list[NodeAnswer]:
    """Return the answers to commands."""
    return [message for _, message in said if isinstance(message, NodeAnswer)]
