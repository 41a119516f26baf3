"""The core and simulated nodes against what the mode manager of micro-ROS system_modes does."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from domain.commands import AskFacts, AskParameters, AskTransition, NodeCommand
from domain.errors import PilothouseError
from domain.inputs import Input, ModeRequest, NodeAnswer, NodeReport, TransitionRequest
from domain.lifecycle import Transition
from domain.parts.system_model import SmhModel
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.nodes import NodeMessage, SimulatedNodes
from domain.state_and_mode import PartName, StateAndMode
from domain.timebase import Instant, seconds
from service.files.model_file import read_model
from tests.support.core_robot import CoreRobot
from tests.support.manager_vectors import OVERRULED, Case, Pair, run_case
from tests.support.shared import json_cases, shared_folder

AT_ONCE = NodeSettings(
    configure=0,
    activate=0,
    deactivate=0,
    cleanup=0,
    shutdown=0,
    set_parameters=0,
    process_error=seconds(1_000),
)
"""As the nodes of the vectors, which do all at once and stay in `errorprocessing`."""
BEHAVIOURS = {"": None, "failure": Fault.FAIL, "error": Fault.ERROR}
NOT_THERE = NodeSettings(fault=Fault.DIE)


class NodesWithFakes(SimulatedNodes):
    """Simulated nodes, of which some take every transition and never report a state."""

    def __init__(
        self, model: SmhModel, settings: Mapping[PartName, NodeSettings], fakes: set[str]
    ) -> None:
        super().__init__(model, settings, 0)
        self._fakes: dict[str, dict[str, Any]] = {fake: {} for fake in fakes}
        self._said: list[NodeMessage] = []
        self._now = 0
        self.asked: list[NodeCommand] = []
        """Everything that was asked of any node."""

    def handle(self, command: NodeCommand, now: Instant) -> None:
        self.asked.append(command)
        values = self._fakes.get(command.node)
        if values is None:
            super().handle(command, now)
            return
        self._now = now
        match command:
            case AskTransition():
                self._said.append(NodeAnswer(command.request, command.node, True))
            case AskParameters():
                self._said.append(NodeAnswer(command.request, command.node, True))
                self.set_parameters(command.node, command.values, now)
            case AskFacts():
                self._said.append(NodeReport(command.node, parameters=dict(values)))

    def set_parameters(self, node: PartName, values: Mapping[str, Any], now: Instant) -> None:
        if node in self._fakes:
            self._fakes[node] |= values
            self._said.append(NodeReport(node, parameters=dict(values), reachable=True))
            self._now = now
        else:
            super().set_parameters(node, values, now)

    def parameters_of(self, node: PartName) -> Mapping[str, Any]:
        return self._fakes[node] if node in self._fakes else super().parameters_of(node)

    def advance(self, now: Instant) -> tuple[NodeMessage, ...]:
        said, self._said = self._said, []
        heard = [m for m in super().advance(now) if m.node not in self._fakes]
        return (*heard, *said)

    def wake_at(self) -> Instant | None:
        return self._now if self._said else super().wake_at()


class Core:
    """The core over simulated nodes, in the words of the vectors."""

    def __init__(self, model: SmhModel, case: Case) -> None:
        kinds = {node["name"]: node["kind"] for node in case["nodes"]}
        plain = NodeSettings(set_parameters=0, plain=True)
        by_kind = {"lifecycle": AT_ONCE, "plain": plain, "fake": NOT_THERE, "absent": NOT_THERE}
        settings = {node: by_kind[kinds.get(node, "absent")] for node in model.nodes}
        fakes = {name for name, kind in kinds.items() if kind == "fake"}
        self.robot = CoreRobot(model, nodes={str(node): own for node, own in settings.items()})
        self.nodes = NodesWithFakes(model, settings, fakes)
        self.robot.nodes = self.robot.robot.nodes = self.nodes
        self._known = {
            node["name"]: [n for m in model.nodes[PartName(node["name"])].modes.values() for n in m]
            for node in case["nodes"]
        }
        for node in case["nodes"]:
            values = {name: node["parameters"][name] for name in self._known[node["name"]]}
            self.set_parameters(node["name"], values)

    def request_transition(self, part: str, transition: str) -> bool:
        if transition not in set(Transition):
            return False
        return self._ask(TransitionRequest(PartName(part), Transition(transition)))

    def request_mode(self, part: str, mode: str) -> bool:
        return self._ask(ModeRequest(PartName(part), mode))

    def wait(self, seconds: float) -> None:
        self.robot.advance(seconds)

    def trigger(self, node: str, transition: str) -> None:
        command = AskTransition(0, PartName(node), Transition(transition))
        self.nodes.handle(command, self.robot.now)
        self.robot.advance(0)

    def set_parameters(self, node: str, values: Mapping[str, Any]) -> None:
        self.nodes.set_parameters(PartName(node), values, self.robot.now)
        self.robot.advance(0)

    def set_behaviour(self, node: str, on_transition: str) -> None:
        self.robot.fault(node, BEHAVIOURS[on_transition])

    def actual(self) -> dict[str, Pair]:
        views = self.robot.core.parts().items()
        return {
            part: {**_pair(view.actual.state_and_mode), "undecidable": view.actual.undecidable}
            for part, view in views
        }

    def targets(self) -> dict[str, Pair | None]:
        views = self.robot.core.parts().items()
        in_force = {part: view.effective_target for part, view in views}
        return {
            part: {"state": str(target.state), "mode": target.mode or ""} if target else None
            for part, target in in_force.items()
        }

    def node(self, name: str) -> tuple[str, Mapping[str, Any]]:
        known = self.nodes.parameters_of(PartName(name))
        return str(self.nodes.state_of(PartName(name))), {n: known[n] for n in self._known[name]}

    def take_requests(self) -> Mapping[str, tuple[set[str], dict[str, Any]]]:
        requests: dict[str, tuple[set[str], dict[str, Any]]] = {}
        for command in self.nodes.asked:
            transitions, parameters = requests.setdefault(command.node, (set(), {}))
            match command:
                case AskTransition():
                    transitions.add(str(command.transition))
                case AskParameters():
                    parameters.update(command.values)
        self.nodes.asked.clear()
        return requests

    def _ask(self, request: Input) -> bool:
        try:
            self.robot.give(request)
        except PilothouseError:
            return False
        self.robot.advance(0)
        return True


def _pair(pair: StateAndMode) -> Pair:
    return {"state": str(pair.state), "mode": pair.mode or ""}


def model_of(case: Case) -> SmhModel:
    folder = shared_folder("conformance") / "system_modes"
    return read_model(Path(folder, case["model"]["path"]).read_text(encoding="utf-8")).model


def cases() -> list[Any]:
    return list(json_cases("conformance/system_modes/cases", "manager.json", "cases"))


def _differing(case: Case) -> dict[tuple[str, int, str], str]:
    """Return every fact that is otherwise here, with both values in words."""
    return {
        (case["name"], number, what): f"{expected} expected, {found} found"
        for number, what, expected, found in run_case(case, Core(model_of(case), case))
        if found != expected
    }


@pytest.mark.parametrize("case", cases())
def test_requests_end_as_the_vectors_say(case: Case) -> None:
    """A fact that is overruled must differ: what does not any more is not overruled."""
    differing = _differing(case)
    overruled = {fact for fact in OVERRULED if fact[0] == case["name"]}
    unexpected = {fact: words for fact, words in differing.items() if fact not in overruled}
    assert unexpected == {}
    assert differing.keys() == overruled


def test_only_cases_that_there_are_are_overruled() -> None:
    shared_folder("conformance/system_modes")
    names = {parameters.values[0]["name"] for parameters in cases()}
    assert {name for name, _, _ in OVERRULED} <= names
