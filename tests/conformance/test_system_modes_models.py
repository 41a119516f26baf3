"""Model files against what the C++ of micro-ROS system_modes reads from them, or refuses.

Where C++ reads a model that it then crashes on or misunderstands, this project refuses it. These
cases are in `OVERRULED`, each with the reason, and in docs/conformance.md.
"""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from domain.errors import InvalidModelError
from domain.lifecycle import LifecycleState
from domain.parts.system_model import Rule, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode
from service.files.model_file import load_model, read_model
from service.files.text_file import UnreadableFileError
from tests.support.shared import json_cases, shared_folder

Case = dict[str, Any]

OVERRULED: Mapping[str, tuple[str, str]] = {
    "type_other_is_system": (
        "PARAMETERS_OF_A_SYSTEM",
        "a node with a misspelt type would be a system without parts",
    ),
    "upper_case_state_becomes_unknown": ("UNKNOWN_STATE", "no part is ever in the state unknown"),
    "garbage_state_becomes_unknown": ("UNKNOWN_STATE", "no part is ever in the state unknown"),
    "unknown_part_mode_accepted": ("UNKNOWN_MODE", "the mode can never be reached"),
    "undeclared_part_accepted": ("UNKNOWN_PART", "a request for the mode ends the C++ manager"),
    "duplicate_mode_merges": ("DUPLICATE_KEY", "one of the two was meant"),
    "duplicate_node_merges": ("DUPLICATE_KEY", "one of the two was meant"),
    "dotted_mode_name_cut": ("DOTTED_NAME", "the mode gets another name than is written"),
    "cycle_accepted": ("CYCLE", "the first inference ends the C++ process"),
    "rules_incomplete_accepted": ("INCOMPLETE_RULE", "the rule never acts"),
}
"""Cases that C++ accepts: the finding with which they are refused, and why."""

ACCEPTED: Mapping[str, str] = {
    "default_must_come_first": "the order of modes means nothing",
}
"""Cases that C++ refuses and this project reads, with the reason."""

DIFFERENT_WORDS: Mapping[str, str] = {
    "ACTIVE": "a word that is no state is refused, and not taken as unknown",
    "": "a word that is no state is refused, and not taken as unknown",
    "activating.X": "the mode in which the parts are on the way is shown",
    "inactive.FOO": "a mode that has no effect is not kept",
}
"""State and mode as text, where it is read or written differently, with the reason."""


def cases(*suites: str) -> list[Any]:
    return [
        case
        for suite in suites
        for case in json_cases("conformance/system_modes/cases", f"{suite}.json", "cases")
    ]


def model_of(case: Case) -> SmhModel:
    if "yaml" in case["model"]:
        return read_model(case["model"]["yaml"]).model
    return load_model(Path(shared_folder("conformance/system_modes"), case["model"]["path"])).model


def expected(case: Case, what: str) -> Any:  # noqa: ANN401  # as in JSON
    found = [step["expect"][what] for step in case["steps"] if what in step.get("expect", {})]
    return found[0] if found else None


@pytest.mark.parametrize("case", cases("parser", "unit_modes", "unit_rules"))
def test_a_model_is_read_as_cpp_reads_it_or_refused_as_cpp_refuses_it(case: Case) -> None:
    if case["name"] in OVERRULED:
        code, _ = OVERRULED[case["name"]]
        with pytest.raises(InvalidModelError) as caught:
            model_of(case)
        assert expected(case, "load") is None
        assert code in {finding.code for finding in caught.value.findings}
        return
    if case["name"] in ACCEPTED:
        assert expected(case, "load") is not None
        assert model_of(case).parts
        return
    if expected(case, "load") is not None:
        with pytest.raises((InvalidModelError, UnreadableFileError)):
            model_of(case)
        return
    model = model_of(case)
    assert_parts(model, case)
    assert_rules(model, case)


def assert_parts(model: SmhModel, case: Case) -> None:
    systems, nodes, modes = (expected(case, key) for key in ("systems", "nodes", "modes"))
    whole = expected(case, "model")
    if whole is not None:
        systems, nodes, modes = whole["systems"], whole["nodes"], whole["modes"]
    assert systems is None or sorted(model.systems) == systems
    assert nodes is None or sorted(model.nodes) == nodes
    for part, wanted in (modes or {}).items():
        assert set(model.modes_of(PartName(part))) == set(wanted)
        for mode, content in wanted.items():
            assert as_text(mode_of(model, PartName(part), ModeName(mode))) == as_text(content)
    for key, parameters in (expected(case, "mode_definition") or {}).items():
        part, _, mode = key.rpartition("/")
        own = mode_of(model, PartName(part), ModeName(mode))
        assert as_text(own) == as_text({"parameters": parameters})


def mode_of(model: SmhModel, part: PartName, mode: ModeName) -> dict[str, Any]:
    """Return a mode as the vectors have it."""
    if part in model.nodes:
        return {"parameters": dict(model.nodes[part].modes[mode])}
    wants = model.systems[part].modes[mode]
    return {"parts": {p: in_words(want, DEFAULT_MODE) for p, want in wants.items()}}


def as_text(mode: dict[str, Any]) -> str:
    """Return what tells 1 from 1.0 and from true."""
    return json.dumps(mode, sort_keys=True)


def in_words(pair: StateAndMode, no_mode: str = "") -> dict[str, str]:
    return {"state": str(pair.state), "mode": pair.mode or no_mode}


def assert_rules(model: SmhModel, case: Case) -> None:
    for check in [*(expected(case, "rules") or ()), *(expected(case, "rules_count") or ())]:
        target = StateAndMode(
            LifecycleState(check["target"]["state"]), ModeName(check["target"]["mode"]) or None
        )
        system = model.systems[PartName(check["part"])]
        rules = [rule for rule in system.rules if rule.if_target.agrees_with(target)]
        if "count" in check:
            assert len(rules) == check["count"]
        else:
            assert [rule_in_words(system, rule) for rule in rules] == check["rules"]


def rule_in_words(system: SystemModel, rule: Rule) -> dict[str, object]:
    return {
        "name": rule.name,
        "system": system.name,
        "if_target": in_words(rule.if_target),
        "part": rule.if_part[0],
        "if_part": in_words(rule.if_part[1]),
        "new_target": in_words(rule.new_target),
    }


@pytest.mark.parametrize("case", cases("unit_state_and_mode"))
def test_states_and_modes_are_read_and_written_as_in_cpp(case: Case) -> None:
    differing = set()
    for check in expected(case, "parse"):
        try:
            pair = StateAndMode.parse(check["text"])
        except ValueError:
            differing.add(check["text"])
            continue
        if in_words(pair) != check["value"] or pair.label != check["as_string"]:
            differing.add(check["text"])

    assert differing == set(DIFFERENT_WORDS)


@pytest.mark.parametrize("case", cases("unit_state_and_mode"))
def test_states_and_modes_are_equal_as_in_cpp(case: Case) -> None:
    for check in expected(case, "equality"):
        if check["a"] and check["b"]:
            one, other = StateAndMode.parse(check["a"]), StateAndMode.parse(check["b"])
            assert one.agrees_with(other) is check["equal"], check


def test_what_is_overruled_is_a_case_that_there_is() -> None:
    folder = shared_folder("conformance/system_modes/cases")
    text = "".join((folder / f"{suite}.json").read_text() for suite in ("parser", "unit_modes"))

    assert [name for name in (*OVERRULED, *ACCEPTED) if f'"{name}"' not in text] == []


# What the shared models are read with; the rest is read without a word.
WARNINGS = {
    "actuation": ["MODES_ALIKE"],
    "actuation_rules": ["MODES_ALIKE"],
    "issue94": ["RULE_CIRCLE"],
    "launch_namespace": ["MODES_ALIKE"],
    "launch_two_hierarchies": ["MODES_ALIKE", "MODES_ALIKE"],
    "launch_two_nodes": ["MODES_ALIKE"],
    "ties": ["MODES_ALIKE", "MODES_ALIKE"],
}
REFUSED = {"ghost_part", "unit_wrong_parameter"}


def test_the_models_of_the_vectors_are_read_and_what_is_odd_in_them_is_told() -> None:
    paths = sorted(shared_folder("conformance/system_modes/models").glob("*.yaml"))
    readable = [path for path in paths if path.stem not in REFUSED]

    told = {path.stem: [w.code for w in load_model(path).warnings] for path in readable}

    assert {name: codes for name, codes in told.items() if codes} == WARNINGS


def test_the_models_of_the_vectors_that_name_what_there_is_not_are_refused() -> None:
    for name in REFUSED:
        with pytest.raises(InvalidModelError):
            load_model(shared_folder("conformance/system_modes/models") / f"{name}.yaml")
