"""Model files: SMH (system modes and hierarchy) of micro-ROS system_modes, as YAML.

Every file that its C++ code reads correctly is accepted, so that one file serves both; what that
code would crash on or misread is an error. All findings are reported at once, each with its place.

Source: micro-ROS deliverable D4.8, section 4.1; micro-ROS system_modes, README.
"""

import gc
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path

from domain.conditions.check import Fault, check, terms_of
from domain.conditions.tree import Subject, Topic, TopicKind
from domain.conditions.vocabulary import Vocabulary
from domain.errors import InvalidModelError
from domain.findings import Finding
from domain.health.signals import SignalSettings, default_signals
from domain.parts.errors_check import error_circles
from domain.parts.lint.model_lint import lint
from domain.parts.reactions_check import all_reactions, check_reactions
from domain.parts.system_model import EVERY_MODE, SmhModel, find_errors
from domain.robot_vocabulary import vocabulary_of
from service.files.extension import NAMES_OF_CPP, is_in_extension
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, read_parameter_file
from service.files.smh_block import MODE_SETTINGS
from service.files.smh_reader import SmhParts, read_parts
from service.files.source_text import SourceText
from service.files.text_file import read_text_file
from service.files.yaml_tree import Mapping, Node, Scalar, Sequence, finding_at, in_order, read_tree

EXAMPLE = Path(str(resources.files("service") / "example" / "actuation.yaml"))
"""The model of a service that is started without one."""

MAX_FINDINGS = 1_000
"""Largest number of findings reported for one model; the rest is counted."""


@dataclass(frozen=True, slots=True)
class LoadedModel:
    """A model with its source text."""

    model: SmhModel
    warnings: tuple[Finding, ...]
    text: str
    name: str = ""
    """Of its file, without the folder; empty: not known."""


def load_model(path: Path) -> LoadedModel:
    """Read a model from a file.

    Raises:
        UnreadableFileError: There is no such file, or it is not a text file.
        InvalidModelError: The model is invalid; `findings` hold all errors.
    """
    return replace(read_model(read_text_file(path)), name=path.name)


def read_model(text: str, signals: Collection[SignalSettings] | None = None) -> LoadedModel:
    """Read a model from YAML.

    Args:
        text: The text of the file.
        signals: All signals of the robot; a condition that names another one is an error. None:
            not known, since there is no robot file; that is a warning then.

    Raises:
        InvalidModelError: The model is invalid; `findings` hold all errors.
    """
    model, findings = _read(text, signals)
    if model is None:
        raise InvalidModelError(findings)
    return LoadedModel(model, findings, text)


def with_signals(loaded: LoadedModel, signals: Collection[SignalSettings]) -> LoadedModel:
    """Return a model whose conditions were checked against all signals of the robot.

    Raises:
        InvalidModelError: A condition names another one.
    """
    if not loaded.model.has_conditions:
        return loaded
    return replace(read_model(loaded.text, signals), name=loaded.name)


def check_model(
    text: str, signals: Collection[SignalSettings] | None = None
) -> tuple[Finding, ...]:
    """Return the errors and warnings of a model in the order of the text.

    Args:
        text: The text of the file.
        signals: All signals of the robot, or None, as for `read_model`.
    """
    return _read(text, signals)[1]


def _read(
    text: str, signals: Collection[SignalSettings] | None
) -> tuple[SmhModel | None, tuple[Finding, ...]]:
    """Return the model, if it is valid, and all findings."""
    with _collector_paused():
        return _read_all(text, signals)


@contextmanager
def _collector_paused() -> Iterator[None]:
    """Pause the garbage collector while reading, since all new objects are in use.

    Reading a model of 10,000 nodes takes three times as long otherwise.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _read_all(
    text: str, signals: Collection[SignalSettings] | None
) -> tuple[SmhModel | None, tuple[Finding, ...]]:
    tree = read_tree(text, is_in_extension)
    if not tree.is_complete:
        return None, _limited(in_order(text, tree.findings))
    file = read_parameter_file(tree.documents, NAMES_OF_CPP)
    source = SourceText(text)
    parts = read_parts(file.nodes, source)
    places = _Places(file.nodes)
    findings = [*tree.findings, *file.findings, *map(places.placed, parts.findings)]
    known = default_signals() if signals is None else signals
    vocabulary = vocabulary_of(parts, known, is_complete=signals is not None)
    findings.extend(_faults_of_conditions(parts, source, vocabulary))
    findings.extend(_faults_of_causes(parts, vocabulary))
    model = None
    if _has_errors(findings):
        found = [
            *find_errors(parts.nodes, parts.systems),
            *error_circles(parts.errors),
            *_faults_of_reactions(parts),
        ]
    else:
        model, found = _build(parts, vocabulary)
    findings.extend(map(places.placed, found))
    return model, _limited(in_order(text, _each_once(findings)))


def _build(parts: SmhParts, vocabulary: Vocabulary) -> tuple[SmhModel | None, list[Finding]]:
    """Return the model and its warnings, or its errors."""
    try:
        model = SmhModel(
            parts.nodes, parts.systems, parts.mode_settings, parts.errors, parts.reactions
        )
    except InvalidModelError as error:
        return None, list(error.findings)
    found = lint(model, vocabulary)
    if not model.parts:
        message = "the model has no parts"
        found.append(Finding("warning", "NO_PARTS", message, line=1, column=1))
    return model, found


def _faults_of_conditions(
    parts: SmhParts, source: SourceText, vocabulary: Vocabulary
) -> Iterator[Finding]:
    """Yield what is wrong in conditions, each at its character in the file."""
    for own in parts.conditions:
        for fault in check(own.condition, vocabulary):
            place = source.place(own.place, own.shift + fault.column - 1)
            message = f"{own.where}: {fault.message}"
            yield finding_at(place, fault.code, message, own.part, fault.severity)


def _faults_of_causes(parts: SmhParts, vocabulary: Vocabulary) -> Iterator[Finding]:
    """Yield which causes are no errors, each at its place in the file."""
    for own in parts.causes:
        part, error = own.cause
        found = terms_of(Subject(Topic(TopicKind.ERROR, error, part or "")), vocabulary)
        if isinstance(found, Fault):
            message = f"{own.where}: {found.message}"
            yield finding_at(own.place, found.code, message, own.part, found.severity)


def _faults_of_reactions(parts: SmhParts) -> Iterator[Finding]:
    """Yield what is wrong with reactions, also while something else is."""
    modes_of = {name: part.modes.keys() for name, part in (parts.nodes | parts.systems).items()}
    reactions = all_reactions(parts.reactions)
    return check_reactions(reactions, modes_of, parts.nodes, parts.errors)


def _has_errors(findings: Iterable[Finding]) -> bool:
    return any(finding.severity == "error" for finding in findings)


def _each_once(findings: Iterable[Finding]) -> list[Finding]:
    """Return the findings, of one code at one place the first: modes share what `__ALL__` says."""
    first = {(f.code, f.line, f.column): f for f in reversed(list(findings))}
    return list(first.values())[::-1]


def _limited(findings: list[Finding]) -> tuple[Finding, ...]:
    """Return at most `MAX_FINDINGS`, errors before warnings."""
    if len(findings) <= MAX_FINDINGS:
        return tuple(findings)
    kept = sorted(findings, key=lambda finding: finding.severity)[: MAX_FINDINGS - 1]
    more = len(findings) - len(kept)
    last = replace(kept[-1], code="MORE_FINDINGS", message=f"and {more} more", part=None, path=())
    return (*kept, last)


class _Places:
    """Finds the place of a path of keys; each mapping is indexed once."""

    def __init__(self, sources: dict[str, NodeParameters]) -> None:
        self._sources = sources
        self._indices: dict[int, dict[str, tuple[Scalar, Node | None]]] = {}

    def placed(self, finding: Finding) -> Finding:
        """Return the finding with line and column of its path, as far as the path exists.

        What a mode does not say about itself may be said for all modes.
        """
        path = finding.path
        if not path or finding.line is not None:
            return finding
        source = self._sources[path[0]]
        place, is_found = self._find(source.tree, path[1:])
        if not is_found and path[1:2] == (MODE_SETTINGS,):
            of_all, is_found = self._find(source.tree, (MODE_SETTINGS, EVERY_MODE, *path[3:]))
            place = of_all if is_found else place
        place = place or source.key
        return replace(finding, line=place.line, column=place.column)

    def _find(self, tree: Node | None, path: tuple[str, ...]) -> tuple[Scalar | None, bool]:
        """Return the place of a path, or the last one on the way there, and whether it is found.

        A key may hold several steps of the path, separated by dots. The last step may be the text
        of a value, alone or in a list.
        """
        if not path:
            return None, True
        if not isinstance(tree, Mapping):
            return _text_in(tree, path)
        index = self._index(tree)
        for length in range(1, len(path) + 1):
            found = index.get(".".join(path[:length]))
            if found is not None:
                key, value = found
                below, is_found = self._find(value, path[length:])
                return below or key, is_found
        _, hidden = index.get(PARAMETERS_KEY, (None, None))
        return self._find(hidden, path) if isinstance(hidden, Mapping) else (None, False)

    def _index(self, tree: Mapping) -> dict[str, tuple[Scalar, Node | None]]:
        if id(tree) not in self._indices:
            self._indices[id(tree)] = {
                key.text.removeprefix("/"): (key, value) for key, value in tree.entries
            }
        return self._indices[id(tree)]


def _text_in(node: Node | None, path: tuple[str, ...]) -> tuple[Scalar | None, bool]:
    """Return the scalar of a text."""
    items = node.items if isinstance(node, Sequence) else [node]
    for item in items:
        if isinstance(item, Scalar) and item.text.strip() == path[0]:
            return item, len(path) == 1
    return None, False
