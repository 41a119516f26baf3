"""Scenario files: the body of `POST /simulations` as YAML or JSON, with references to files.

`model_file`, `robot_file` and the `file` with the waypoints of a task are paths relative to the
scenario. The contents of these files replace them in the body. All findings are reported with file,
line and column.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from api.http.body_parsing import InvalidBodyError
from api.http.schemas.simulation import SimulationBody, place_in_body
from api.simulation.simulation_job import robot_for
from domain.errors import InvalidModelError, InvalidValueError
from domain.findings import Finding
from domain.paths.headings import Heading
from service.files.csv_columns import column_names
from service.files.csv_table import InvalidWaypointsError
from service.files.parameter_file import scalar_value
from service.files.text_file import UnreadableFileError, decode_csv, read_bytes, read_text_file
from service.files.waypoint_file import read_waypoints_csv
from service.files.yaml_tree import (
    Mapping,
    Node,
    Scalar,
    finding_at,
    in_order,
    read_tree,
)
from service.files.yaml_tree import Sequence as Items
from service.simulation.virtual_time import VirtualService

Keys = tuple[int | str, ...]
"""The way to a value, from the top of a file."""

_STANDARD_INPUT = Path("/dev/stdin")
_NOTHING = frozenset(["", "~", "null", "Null", "NULL"])
_WORDS = {"extra_forbidden": "unknown key", "missing": "missing key"}


class InvalidScenarioError(Exception):
    """An invalid scenario file; `findings` are its faults, each with the name of its file.

    Only the command raises it: a posted scenario is a body like any other.
    """

    def __init__(self, findings: Sequence[tuple[str, Finding]]) -> None:
        more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
        super().__init__(f"the scenario is invalid: {findings[0][1].message}{more}")
        self.findings = tuple(findings)


@dataclass(slots=True)
class _Source:
    """A YAML file: its tree with places, and its findings."""

    name: str
    root: Node = field(default_factory=lambda: Mapping(1, 1))
    findings: list[Finding] = field(default_factory=list)

    def complain(self, keys: Keys, message: str, code: str = "INVALID_VALUE") -> None:
        """Add a finding about the value at `keys`."""
        self.findings.append(finding_at(place_of(self.root, keys), code, message))

    def raise_if_faulty(self) -> None:
        """Raise if there are findings.

        Raises:
            InvalidScenarioError: There are.
        """
        if self.findings:
            raise InvalidScenarioError([(self.name, finding) for finding in self.findings])


@dataclass(frozen=True, slots=True)
class Scenario:
    """A valid scenario, and its robot."""

    file: str
    body: SimulationBody
    robot: VirtualService
    root: Node

    def line_of(self, step: int, path: str = "") -> int:
        """Return the line of a step in the file, or of what it expects at `path`."""
        inner = ("expect", *path.split(".")) if path else ()
        return place_of(self.root, ("steps", step, *inner)).line


def load_scenario(
    name: str, loaded_model: str, model: Path | None = None, robot: Path | None = None
) -> Scenario:
    """Read a scenario and prepare its robot.

    Args:
        name: Path of the file; `-` is the standard input, whose paths are relative to the working
            directory.
        loaded_model: Text of the default model.
        model: Model file that replaces the model of the scenario.
        robot: Robot file that replaces the settings of the scenario.

    Raises:
        UnreadableFileError: One of these files does not exist, or is not text.
        InvalidScenarioError: The scenario, or a file that it names, is invalid.
    """
    path = _STANDARD_INPUT if name == "-" else Path(name)
    folder = Path() if name == "-" else path.parent
    source, data = _read_yaml(name, read_text_file(path))
    if not isinstance(data, dict):
        source.complain((), "a scenario must have keys, at least until_s")
        source.raise_if_faulty()
    model_file = _named_file(source, data, "model", folder, model)
    robot_file = _named_file(source, data, "robot", folder, robot)
    source.raise_if_faulty()
    if model_file is not None:
        data["model"] = _text_for(source, "model", model_file, model)
    settings = source
    if robot_file is not None:
        text = _text_for(source, "robot", robot_file, robot)
        settings, data["robot"] = _read_yaml(str(robot_file), text)
        if isinstance(data["robot"], dict) and "start_task" in data["robot"]:
            message = "start_task has no effect in a simulation: use a task step of the scenario"
            settings.complain(("start_task",), message)
            settings.raise_if_faulty()
    _fill_in_tracks(source, data, folder)
    source.raise_if_faulty()
    body = _validated(source, settings, data)
    return Scenario(
        name, body, _robot(source, settings, body, loaded_model, model_file), source.root
    )


def place_of(root: Node, keys: Keys) -> Node:
    """Return the last thing on the way along `keys` that is in the file."""
    place: Node = root
    tree: Node | None = root
    for key in keys:
        if isinstance(tree, Items) and isinstance(key, int) and key < len(tree.items):
            tree = tree.items[key]
            place = tree or place
        elif isinstance(tree, Mapping):
            found = next((entry for entry in tree.entries if entry[0].text == key), None)
            if found is None:
                break
            place, tree = found
        else:
            break
    return place


# --- files and what they name --------------------------------------------------------------------


def _read_yaml(name: str, text: str) -> tuple[_Source, Any]:
    """Return a file with what it says as plain values.

    Raises:
        InvalidScenarioError: It is not YAML, nor JSON.
    """
    tree = read_tree(text)
    source = _Source(name, findings=in_order(text, tree.findings))
    source.raise_if_faulty()
    documents = [document for document in tree.documents if document is not None]
    if documents:
        source.root = documents[0]
    if len(documents) > 1:
        message = "a scenario file holds one document only"
        source.findings.append(finding_at(documents[1], "INVALID_VALUE", message))
        source.raise_if_faulty()
    return source, _plain(source.root)


def _plain(node: Node | None) -> Any:  # noqa: ANN401  # as in JSON
    """Return a tree as plain values; scalars mean what they mean in a model, and null is null."""
    match node:
        case Scalar():
            is_nothing = node.text in _NOTHING and not node.is_quoted and node.tag is None
            return None if is_nothing else scalar_value(node)
        case Items():
            return [_plain(item) for item in node.items]
        case Mapping():
            return {key.text: _plain(value) for key, value in node.entries}
        case None:
            return None


def _named_file(
    source: _Source, data: dict[str, Any], what: str, folder: Path, given: Path | None
) -> Path | None:
    """Take `model_file` or `robot_file` out of the scenario; return the file that is to be read."""
    key = f"{what}_file"
    named = data.pop(key, None)
    if named is not None and data.get(what) is not None:
        source.complain((key,), f"{what} is given as well; leave out one of them")
    if named is not None and not isinstance(named, str):
        source.complain((key,), f"{key}: the path of a file is needed")
        return None
    if given is not None:
        data.pop(what, None)
        return given
    return None if named is None else folder / named


def _text_for(source: _Source, what: str, path: Path, given: Path | None) -> str:
    """Return the text of a file that the scenario names, or that was given instead.

    Raises:
        UnreadableFileError: The one that was given cannot be read.
        InvalidScenarioError: The other one cannot be.
    """
    try:
        return read_text_file(path)
    except UnreadableFileError as error:
        if given is None:
            source.complain((f"{what}_file",), error.message, error.code)
            source.raise_if_faulty()
        raise


def _fill_in_tracks(source: _Source, data: dict[str, Any], folder: Path) -> None:
    """Put the waypoints of files into the tasks that name them."""
    steps = data.get("steps")
    for index, step in enumerate(steps if isinstance(steps, list) else ()):
        task = step.get("task") if isinstance(step, dict) else None
        if isinstance(task, dict) and "file" in task:
            step["task"] = _with_waypoints(source, ("steps", index, "task"), task, folder)


def _with_waypoints(
    source: _Source, keys: Keys, task: dict[str, Any], folder: Path
) -> dict[str, Any]:
    taken = ("file", "heading", "columns")
    more = {key: value for key, value in task.items() if key not in taken}
    name, heading, columns = task["file"], task.get("heading"), task.get("columns")
    if not isinstance(name, str):
        source.complain((*keys, "file"), "file: the path of a CSV is needed")
    elif "waypoints" in task:
        source.complain((*keys, "file"), "waypoints are given as well; leave out one of them")
    elif not isinstance(columns, str | None):
        source.complain((*keys, "columns"), "columns: names of columns, such as x,y,yaw")
    elif heading is not None and heading not in tuple(Heading):
        message = f"heading: one of {', '.join(Heading)}"
        source.complain((*keys, "heading"), message)
    else:
        try:
            names = None if columns is None else column_names(columns)
            unit = None if heading is None else Heading(heading)
            text = decode_csv(read_bytes(folder / name))
            rows = read_waypoints_csv(text, unit, names).tolist()
        except InvalidValueError as error:
            source.complain((*keys, "columns"), f"columns: {error.message}")
        except UnreadableFileError as error:
            source.complain((*keys, "file"), error.message, error.code)
        except InvalidWaypointsError as error:
            hint = (error.hint or "").replace("?heading=", "heading: ")
            hint = hint.replace("?columns=", "columns: ")
            source.complain((*keys, "file"), f"{name}: {error.message}; {hint}", error.code)
        else:
            more["waypoints"] = [{"x_m": x, "y_m": y, "yaw_rad": yaw} for x, y, yaw in rows]
    return more


# --- what is wrong with what they say ------------------------------------------------------------


def _validated(source: _Source, settings: _Source, data: dict[str, Any]) -> SimulationBody:
    """Return the scenario as it would be posted.

    Raises:
        InvalidScenarioError: It is invalid, or a step is after the end.
    """
    try:
        body = SimulationBody.model_validate(data)
    except ValidationError as error:
        faults = error.errors(include_url=False, include_input=False)
        _blame(source, settings, ((place_in_body(fault["loc"]), _words(fault)) for fault in faults))
        raise
    if body.begin is not None:
        source.complain(("from",), "a scenario file has no live robot; leave out `from`")
    late = [index for index, step in enumerate(body.steps) if step.t_s > body.until_s]
    for index in late:
        message = f"this is after the end of the scenario, until_s: {body.until_s:g}"
        source.complain(("steps", index, "t_s"), message)
    source.raise_if_faulty()
    return body


def _robot(
    source: _Source,
    settings: _Source,
    body: SimulationBody,
    loaded_model: str,
    model_file: Path | None,
) -> VirtualService:
    """Return the robot at the start of the scenario.

    Raises:
        InvalidScenarioError: Its model or settings are invalid.
    """
    try:
        return robot_for(body, loaded_model, None)
    except InvalidModelError as error:
        if model_file is not None:
            faults = [(str(model_file), found) for found in error.findings]
            raise InvalidScenarioError(faults) from error
        place = place_of(source.root, ("model",))
        inline = [
            replace(
                finding_at(place, found.code, f"line {found.line} of the model: {found.message}"),
                severity=found.severity,
            )
            for found in error.findings
        ]
        raise InvalidScenarioError([(source.name, found) for found in inline]) from error
    except InvalidBodyError as error:
        faults_of_body = ((_pointed(fault.pointer), fault.message) for fault in error.faults)
        _blame(source, settings, faults_of_body)
        raise


def _blame(source: _Source, settings: _Source, faults: Iterator[tuple[Keys, str]]) -> None:
    """Add each fault to the findings of its file.

    Raises:
        InvalidScenarioError: Always.
    """
    for keys, message in faults:
        where = ".".join(map(str, keys))
        file, inner = (settings, keys[1:]) if keys[:1] == ("robot",) else (source, keys)
        file.complain(
            keys if file is source else inner, f"{where}: {message}" if where else message
        )
    raise InvalidScenarioError(
        [
            (file.name, finding)
            for file in ([source] if settings is source else [source, settings])
            for finding in file.findings
        ]
    )


def _words(fault: Any) -> str:  # noqa: ANN401  # of pydantic
    return _WORDS.get(fault["type"], str(fault["msg"]).removeprefix("Value error, "))


def _pointed(pointer: str) -> Keys:
    """Return the keys of a JSON pointer."""
    return tuple(
        int(key) if key.isdigit() else key.replace("~1", "/").replace("~0", "~")
        for key in pointer.split("/")[1:]
    )
