"""Model files: SMH (system modes and hierarchy) of micro-ROS system_modes, as YAML.

Every file that its C++ code reads correctly is accepted, so that one file serves both; what that
code would crash on or misread is an error. All findings are reported at once, each with its place.

Source: micro-ROS deliverable D4.8, section 4.1; micro-ROS system_modes, README.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from domain.errors import InvalidModelError
from domain.findings import Finding
from domain.parts.model_lint import lint
from domain.parts.system_model import SmhModel, find_errors
from service.files.extension import NAMES_OF_CPP, is_in_extension
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, read_parameter_file
from service.files.smh_reader import SmhParts, read_parts
from service.files.text_file import read_text_file
from service.files.yaml_tree import Mapping, Node, Scalar, in_order, read_tree

MAX_FINDINGS = 1_000
"""Largest number of findings reported for one model; the rest is counted."""


@dataclass(frozen=True, slots=True)
class LoadedModel:
    """A model with its source text."""

    model: SmhModel
    warnings: tuple[Finding, ...]
    text: str


def load_model(path: Path) -> LoadedModel:
    """Read a model from a file.

    Raises:
        UnreadableFileError: There is no such file, or it is not a text file.
        InvalidModelError: The model is invalid; `findings` hold all errors.
    """
    return read_model(read_text_file(path))


def read_model(text: str) -> LoadedModel:
    """Read a model from YAML.

    Raises:
        InvalidModelError: The model is invalid; `findings` hold all errors.
    """
    model, findings = _read(text)
    if model is None:
        raise InvalidModelError(findings)
    return LoadedModel(model, findings, text)


def check_model(text: str) -> tuple[Finding, ...]:
    """Return the errors and warnings of a model in the order of the text."""
    return _read(text)[1]


def _read(text: str) -> tuple[SmhModel | None, tuple[Finding, ...]]:
    """Return the model, if it is valid, and all findings."""
    with _collector_paused():
        return _read_all(text)


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


def _read_all(text: str) -> tuple[SmhModel | None, tuple[Finding, ...]]:
    tree = read_tree(text, is_in_extension)
    if not tree.is_complete:
        return None, _limited(in_order(text, tree.findings))
    file = read_parameter_file(tree.documents, NAMES_OF_CPP)
    parts = read_parts(file.nodes)
    places = _Places(file.nodes)
    findings = [*tree.findings, *file.findings, *map(places.placed, parts.findings)]
    model = None
    if any(finding.severity == "error" for finding in findings):
        found = find_errors(parts.nodes, parts.systems)
    else:
        model, found = _build(parts)
    findings.extend(map(places.placed, found))
    return model, _limited(in_order(text, findings))


def _build(parts: SmhParts) -> tuple[SmhModel | None, list[Finding]]:
    """Return the model and its warnings, or its errors."""
    try:
        model = SmhModel(parts.nodes, parts.systems, parts.mode_settings)
    except InvalidModelError as error:
        return None, list(error.findings)
    found = lint(model)
    if not model.parts:
        message = "the model has no parts"
        found.append(Finding("warning", "NO_PARTS", message, line=1, column=1))
    return model, found


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
        """Return the finding with line and column of its path, as far as the path exists."""
        if not finding.path or finding.line is not None:
            return finding
        source = self._sources[finding.path[0]]
        key = self._find(source.tree, finding.path[1:]) or source.key
        return replace(finding, line=key.line, column=key.column)

    def _find(self, tree: Mapping, path: tuple[str, ...]) -> Scalar | None:
        """Return the key at a path, or the last one on the way there; None: there is none.

        A key may hold several steps of the path, separated by dots.
        """
        index = self._index(tree)
        for length in range(1, len(path) + 1):
            found = index.get(".".join(path[:length]))
            if found is not None:
                key, value = found
                below = self._find(value, path[length:]) if isinstance(value, Mapping) else None
                return below or key
        _, hidden = index.get(PARAMETERS_KEY, (None, None))
        return self._find(hidden, path) if path and isinstance(hidden, Mapping) else None

    def _index(self, tree: Mapping) -> dict[str, tuple[Scalar, Node | None]]:
        if id(tree) not in self._indices:
            self._indices[id(tree)] = {
                key.text.removeprefix("/"): (key, value) for key, value in tree.entries
            }
        return self._indices[id(tree)]
