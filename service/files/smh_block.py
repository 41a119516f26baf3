"""The parameters of one part of an SMH file, sorted by subject."""

from collections import defaultdict
from dataclasses import dataclass
from itertools import chain

from domain.conditions.condition import Condition
from domain.findings import Finding
from domain.snapshot import ErrorKey
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, part_name
from service.files.extension import Setting, read_extensions
from service.files.parameter_file import PARAMETERS_KEY, NodeParameters, Parameter
from service.files.yaml_tree import Node, Scalar, finding_at

MODE_SETTINGS = "mode_settings"
"""The block about guards and order of modes."""
ERRORS = "errors"
"""The block about errors of the part."""
REACTIONS = "reactions"
"""The block about what the robot does while something is so."""

_RESERVED_NAMES = frozenset(("state", "states", "mode", "modes", "parameters"))


@dataclass(frozen=True, slots=True)
class WrittenCondition:
    """A condition with its place in the file."""

    part: PartName
    """The part whose block it stands in."""
    where: str
    """The place in words, for messages."""
    condition: Condition
    place: Scalar
    shift: int
    """Characters of the scalar before the condition."""


@dataclass(frozen=True, slots=True)
class WrittenCause:
    """An error that is named as a cause, with its place in the file."""

    part: PartName
    """The part whose block it stands in."""
    where: str
    """The place in words, for messages."""
    cause: ErrorKey
    place: Scalar


class SmhBlock:
    """The block of one part: its `type`, `parts`, `modes` and `rules`, and its extensions.

    Keys that nobody knows are ignored.
    """

    def __init__(self, source: NodeParameters) -> None:
        self.name = PartName(source.name)
        self.findings: list[Finding] = []
        self.key = source.key
        self.type: Parameter | None = None
        self.parts: list[Parameter] = []
        self.modes: dict[ModeName, list[tuple[str, Parameter]]] = {}
        """The lines of each mode: name below the mode, and the parameter."""
        self.conditions: list[WrittenCondition] = []
        self.causes: list[WrittenCause] = []
        self.rules: dict[str, dict[str, Parameter]] = defaultdict(dict)
        self._misread: set[str] = set()
        extensions, findings = read_extensions(source)
        self.findings.extend(findings)
        self.settings: list[Setting] = [s for s in extensions if s.path[0] == MODE_SETTINGS]
        """The lines of `mode_settings`."""
        self.errors: list[Setting] = [s for s in extensions if s.path[0] == ERRORS]
        """The lines of `errors`."""
        self.reactions: list[Setting] = [s for s in extensions if s.path[0] == REACTIONS]
        """The lines of `reactions`."""
        for parameter in source.parameters:
            self._sort(parameter)
        self.is_node = self._tell_kind()
        self.parts_of_system: dict[PartName, None] = {} if self.is_node else self._named_parts()
        """The parts that its modes name, in the order of the file, those of `__DEFAULT__` first."""
        if self.name.rpartition("/")[2] in _RESERVED_NAMES:
            message = (
                f"{self.name}: the last segment of a name must not be one of "
                f"{', '.join(sorted(_RESERVED_NAMES))}, which are reserved in URLs"
            )
            self.complain(self.key, "RESERVED_NAME", message)

    def complain(self, place: Node, code: str, message: str) -> None:
        """Add an error."""
        self.findings.append(finding_at(place, code, message, self.name))

    def warn(self, place: Node, code: str, message: str) -> None:
        """Add a warning."""
        self.findings.append(finding_at(place, code, message, self.name, "warning"))

    def _sort(self, parameter: Parameter) -> None:
        first, _, rest = parameter.name.partition(".")
        if parameter.name == "type":
            self.type = parameter
        elif first == "parts":
            self.parts.append(parameter)
        elif first == "modes":
            self._compare_names(parameter, rest, "rules")
            mode, _, below = rest.partition(".")
            if below:
                self.modes.setdefault(ModeName(mode), []).append((below, parameter))
            else:
                what = f"mode {rest} of {self.name}" if rest else f"modes of {self.name}"
                self._complain_of_block(parameter, what)
        elif first == "rules":
            self._compare_names(parameter, rest, "modes")
            rule, _, below = rest.partition(".")
            if below:
                self.rules[rule][below] = parameter
            else:
                what = f"rule {rest} of {self.name}" if rest else f"rules of {self.name}"
                self._complain_of_block(parameter, what)

    def _compare_names(self, parameter: Parameter, below: str, misread: str) -> None:
        """Warn of a name in which system_modes finds another block; once for each such name."""
        before, found, _ = below.partition(f"{misread}.")
        if not found or before in self._misread:
            return
        self._misread.add(before)
        message = (
            f"{self.name}: system_modes takes {before}{misread} for {misread} of the part, since "
            f"the name ends in {misread!r}; use another name"
        )
        self.warn(parameter.key, "NOT_FOR_CPP", message)

    def _named_parts(self) -> dict[PartName, None]:
        default = self.modes.get(DEFAULT_MODE, [])
        lines = chain(default, *self.modes.values())
        return dict.fromkeys(part_name(below) for below, _ in lines)

    def _complain_of_block(self, parameter: Parameter, what: str) -> None:
        self.complain(parameter.key, "NOT_A_BLOCK", f"{what}: expected keys below")

    def _tell_kind(self) -> bool:
        """Tell nodes from systems; without a type, by the contents of the modes."""
        if self.type is None:
            message = f"{self.name} has no type; add type: node or type: system"
            self.complain(self.key, "MISSING_TYPE", message)
            return any(
                PARAMETERS_KEY in below for lines in self.modes.values() for below, _ in lines
            )
        if self.type.value not in (None, "node", "system"):
            message = f"{self.name} has the unknown type {self.type.value!r}; read as a system"
            self.warn(self.type.place, "UNKNOWN_TYPE", message)
        return self.type.value == "node"
