"""Jobs on posted models and facts: stateless, with the code of the live inference.

Arguments and results can be pickled, since the worker runs these functions.
"""

from collections.abc import Mapping
from functools import lru_cache

from api.http.body_parsing import InvalidBodyError, parse_body, parse_text, pointer_to
from api.http.schemas.base import StateAndModeJson
from api.http.schemas.inference import (
    DeviationJson,
    InferenceBody,
    InferenceJson,
    ModelCheckJson,
    ReportedNodeBody,
    TargetBody,
)
from api.http.schemas.parts import ActualJson
from api.http.schemas.problem import BodyFault
from domain.errors import UnknownPartError
from domain.inputs import NodeReport
from domain.lifecycle import LifecycleState
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import SmhModel
from domain.state_and_mode import ModeName, PartName, StateAndMode, part_name
from service.files.model_file import check_model, read_model


def check_posted(raw: bytes) -> bytes:
    """Return the findings in a posted model, as JSON.

    Args:
        raw: The body, SMH as YAML.

    Raises:
        MalformedBodyError: It is not text.
    """
    findings = check_model(parse_text(raw))
    return ModelCheckJson.of(findings).model_dump_json().encode()


def infer_posted(raw: bytes, loaded: str) -> bytes:
    """Infer states and modes from posted facts, and return them as JSON.

    Args:
        raw: The body, as described by `InferenceBody`.
        loaded: Text of the default model, for a body without a model.

    Raises:
        PilothouseError: The body or its model is invalid.
    """
    body = parse_body(InferenceBody, raw)
    model = _read(loaded) if body.model is None else read_model(body.model).model
    return infer(model, body).model_dump_json().encode()


@lru_cache(maxsize=1)
def _read(text: str) -> SmhModel:
    """Return the loaded model; cached, so that the worker reads it only once."""
    return read_model(text).model


def infer(model: SmhModel, body: InferenceBody) -> InferenceJson:
    """Infer states and modes from targets and facts.

    Raises:
        InvalidBodyError: A part or a state is unknown.
    """
    faults: list[BodyFault] = []
    targets = _targets(model, body.targets, faults)
    reports = _reports(model, body.nodes, faults)
    if faults:
        raise InvalidBodyError(faults)
    inference = ModeInference(model)
    inference.set_targets(targets)
    for report in reports:
        inference.report(report)
    return InferenceJson(
        parts={part: ActualJson.of(inference.actual(part)) for part in model.parts},
        deviations=[
            DeviationJson(
                part=part,
                target=StateAndModeJson.of(target),
                actual=StateAndModeJson.of(actual),
            )
            for part, target, actual in inference.deviations()
        ],
    )


def _targets(
    model: SmhModel, sent: Mapping[str, TargetBody | None], faults: list[BodyFault]
) -> dict[PartName, StateAndMode | None]:
    targets: dict[PartName, StateAndMode | None] = {}
    for name, target in sent.items():
        part = part_name(name)
        if part not in model:
            faults.append(_unknown_part("part", name, "targets"))
        elif target is None:
            targets[part] = None
        elif (state := _state(target.state, ("targets", name), faults)) is not None:
            targets[part] = StateAndMode.parse(f"{state}.{target.mode or ''}")
    return targets


def _reports(
    model: SmhModel, sent: Mapping[str, ReportedNodeBody | None], faults: list[BodyFault]
) -> list[NodeReport]:
    """Return one report for each node with facts."""
    reports = []
    for name, node in sent.items():
        part = part_name(name)
        if part not in model.nodes:
            is_system = part in model.systems
            faults.append(_unknown_part("node", name, "nodes", is_other=is_system))
        elif node is not None:
            state = None if node.state is None else _state(node.state, ("nodes", name), faults)
            mode = ModeName(node.mode) if node.mode else None
            reports.append(NodeReport(part, state, mode, node.parameters))
    return reports


def _state(label: str, place: tuple[str, str], faults: list[BodyFault]) -> LifecycleState | None:
    try:
        return LifecycleState(label)
    except ValueError:
        message = f"there is no lifecycle state {label!r}; states: {', '.join(LifecycleState)}"
        pointer = pointer_to(*place, "state")
        faults.append(BodyFault(pointer=pointer, code="UNKNOWN_STATE", message=message))
        return None


def _unknown_part(what: str, name: str, member: str, *, is_other: bool = False) -> BodyFault:
    pointer = pointer_to(member, name)
    error = (
        UnknownPartError.of_other_kind(name, what) if is_other else UnknownPartError(what, name, ())
    )
    return BodyFault(pointer=pointer, code=error.code, message=error.message)
