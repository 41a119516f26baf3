"""ROS 2 parameter files as rcl reads them: nodes, each with dotted parameters in order.

A node is `name: {ros__parameters: ...}`; mappings around it are namespaces. Keys of nested mappings
are joined by dots, so that `a: {b: 1}` and `a.b: 1` are the same. Scalars follow no YAML schema:
`y` and `on` are booleans, `010` is 8, `~` is a string.

Source: ROS 2 `rcl_yaml_param_parser`, `parse.c` (`parse_file_events`, `get_value`).
"""

import re
from collections.abc import Collection
from collections.abc import Sequence as Values
from dataclasses import dataclass, field
from functools import lru_cache

from domain.findings import Finding
from domain.parameters import ParameterValue
from service.files.yaml_tree import STRING_TAG, Mapping, Node, Scalar, Sequence, finding_at

PARAMETERS_KEY = "ros__parameters"

_TRUE = frozenset(["y", "Y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"])
_FALSE = frozenset(["n", "N", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"])
_DOTTED_WORD = re.compile(r"\.(nan|NaN|NAN)|[+-]?\.(inf|Inf|INF)")
# What strtoll takes with base 0, and what strtod takes, each to the end of the text.
_INTEGER = re.compile(r"([+-]?)(?:(0[xX][0-9a-fA-F]+)|(0[0-7]*)|([1-9][0-9]*))")
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_HEXADECIMAL = re.compile(
    r"[+-]?0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)(?:[pP][+-]?[0-9]+)?"
)
_WORD = re.compile(r"[+-]?(?:inf(?:inity)?|nan)", re.IGNORECASE)
_SMALLEST_NORMAL = 2.0**-1022

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*(?:/[A-Za-z_][A-Za-z0-9_]*)*")
_LONGEST_NAME = 255


@dataclass(slots=True)
class Parameter:
    """One parameter of a node."""

    name: str
    """With dots, as in `modes.FAST.ros__parameters.max_speed`."""
    key: Scalar
    value: ParameterValue | None
    """None: a finding has already been reported for it."""
    place: Node
    """Place of the value, or of the key if there is none."""


@dataclass(slots=True)
class NodeParameters:
    """A node of a parameter file."""

    name: str
    """Without the leading slash."""
    key: Scalar
    tree: Mapping
    parameters: list[Parameter] = field(default_factory=list)
    extensions: list[tuple[Scalar, Node | None]] = field(default_factory=list)
    """The keys that no ROS program reads, with what is below them."""


@dataclass(slots=True)
class ParameterFile:
    """All nodes in the order of the file, and the findings."""

    nodes: dict[str, NodeParameters] = field(default_factory=dict)
    findings: list[Finding] = field(default_factory=list)


def read_parameter_file(
    documents: Values[Node | None], names: Collection[str] | None = None
) -> ParameterFile:
    """Read the nodes of all documents.

    Args:
        documents: The trees of the file.
        names: First words of the names of parameters; other keys are extensions. None: there are
            no extensions.
    """
    reader = _Reader(names)
    for document in documents:
        if isinstance(document, Mapping):
            reader.read_namespace(document, None)
        elif document is not None:
            message = f"expected names of parts, each with {PARAMETERS_KEY} below it"
            reader.complain(document, "NOT_A_BLOCK", message)
    return reader.file


def scalar_value(scalar: Scalar) -> bool | int | float | str | None:
    """Return the value of a scalar; None: it is empty and not quoted."""
    if scalar.is_quoted or scalar.tag == STRING_TAG:
        return scalar.text
    return plain_value(scalar.text) if scalar.text else None


@lru_cache(maxsize=10_000)
def plain_value(text: str) -> bool | int | float | str:
    """Return the value that rcl reads from an unquoted scalar.

    Numbers too large for a 64-bit integer become doubles; those out of the range of a double stay
    strings, since `strtod` rejects them.
    """
    if text in _TRUE:
        return True
    if text in _FALSE:
        return False
    integer = _INTEGER.fullmatch(text)
    if integer:
        sign, sixteen, eight, ten = integer.groups()
        digits, base = (sixteen, 16) if sixteen else (eight, 8) if eight else (ten, 10)
        number = int(sign + digits, base) if len(digits) < 30 else 2**63
        if -(2**63) <= number < 2**63:
            return number
    return _double(text)


def _double(text: str) -> float | str:
    if _DOTTED_WORD.fullmatch(text):
        return float(text.replace(".", ""))
    if _WORD.fullmatch(text):
        return float(text)
    if _DECIMAL.fullmatch(text):
        number = float(text)
    elif _HEXADECIMAL.fullmatch(text):
        try:
            number = float.fromhex(text)
        except OverflowError:
            return text
    else:
        return text
    is_out_of_range = abs(number) == float("inf") or 0 < abs(number) < _SMALLEST_NORMAL
    is_too_small = number == 0 and re.search("[1-9]", re.split("[eEpP]", text)[0]) is not None
    return text if is_out_of_range or is_too_small else number


class _Reader:
    """Traverses the trees, whose depth is limited."""

    def __init__(self, names: Collection[str] | None) -> None:
        self.file = ParameterFile()
        self._names = names

    def complain(self, place: Node, code: str, message: str) -> None:
        """Add an error."""
        self.file.findings.append(finding_at(place, code, message))

    def read_namespace(self, tree: Mapping, above: str | None) -> None:
        """Read the keys above `ros__parameters`."""
        own: Scalar | None = None
        for key, value in tree.entries:
            if key.text == PARAMETERS_KEY:
                own = key
                if above is None:
                    self.complain(key, "MISPLACED_KEY", f"{PARAMETERS_KEY} must be below a name")
            elif own is not None:
                message = (
                    f"rcl misreads keys after {PARAMETERS_KEY}; write {key.text} before it, or "
                    "with its full name at the top level"
                )
                self.complain(key, "MISPLACED_KEY", message)
            elif isinstance(value, Mapping):
                name = key.text if above is None else f"{above}/{key.text}"
                self._read_name(name, key, value)
            elif value is not None:
                message = f"{key.text} must have {PARAMETERS_KEY} below it"
                self.complain(key, "MISSING_ROS_PARAMETERS", message)

    def _read_name(self, name: str, key: Scalar, value: Mapping) -> None:
        if not value.entries:
            message = f"{name} must have {PARAMETERS_KEY} below it"
            self.complain(key, "MISSING_ROS_PARAMETERS", message)
        for below, parameters in value.entries:
            if below.text == PARAMETERS_KEY:
                self._read_node(name, key, below, parameters)
        self.read_namespace(value, name)

    def _read_node(self, name: str, key: Scalar, below: Scalar, tree: Node | None) -> None:
        name = name.removeprefix("/")
        if tree is None:
            return
        if not isinstance(tree, Mapping):
            self.complain(
                below, "NOT_A_BLOCK", f"{PARAMETERS_KEY} of {name} must have keys below it"
            )
            return
        if not _NAME.fullmatch(name) or len(name) > _LONGEST_NAME:
            message = (
                f"invalid ROS 2 name {name!r:.80}: use letters, digits and underscores, no digit "
                "first; slashes separate namespaces"
            )
            self.complain(key, "INVALID_NAME", message)
            return
        if name in self.file.nodes:
            line = self.file.nodes[name].key.line
            self.complain(key, "DUPLICATE_KEY", f"duplicate key {name!r}; first in line {line}")
            return
        node = NodeParameters(name, key, tree)
        self.file.nodes[name] = node
        self._flatten(node, "", tree, {})

    def _flatten(
        self, node: NodeParameters, prefix: str, tree: Mapping, known: dict[str, Scalar]
    ) -> None:
        """Add the parameters below `tree`, each name once."""
        for key, value in tree.entries:
            name = prefix + key.text
            if not prefix and self._is_extension(key):
                node.extensions.append((key, value))
                continue
            if isinstance(value, Mapping):
                if value.entries:
                    self._flatten(node, f"{name}.", value, known)
                else:
                    self._complain_of_nothing(key, key)
                continue
            if name in known:
                self.complain(
                    key,
                    "DUPLICATE_KEY",
                    f"duplicate key {name!r}; first in line {known[name].line}",
                )
                continue
            known[name] = key
            taken = self._value(key, value)
            node.parameters.append(Parameter(name, key, taken, value or key))

    def _is_extension(self, key: Scalar) -> bool:
        return self._names is not None and key.text.partition(".")[0] not in self._names

    def _value(self, key: Scalar, value: Scalar | Sequence | None) -> ParameterValue | None:
        if isinstance(value, Scalar):
            return self._scalar(key, value)
        return None if value is None else self._array(key, value)

    def _scalar(self, key: Scalar, scalar: Scalar) -> bool | int | float | str | None:
        value = scalar_value(scalar)
        if value is None:
            self._complain_of_nothing(key, scalar)
        return value

    def _array(self, key: Scalar, array: Sequence) -> ParameterValue | None:
        values: list[bool | int | float | str] = []
        for item in array.items:
            if item is None:
                return None
            if not isinstance(item, Scalar):
                message = f"{key.text}: a list parameter must hold plain values, not lists or maps"
                self.complain(item, "INVALID_ARRAY", message)
                return None
            value = self._scalar(key, item)
            if value is None:
                return None
            if values and type(value) is not type(values[0]):
                message = (
                    f"{key.text}: {item.text} and {values[0]} have different types; y, n, yes, no, "
                    "on, off, true and false are booleans unless quoted"
                )
                self.complain(item, "INVALID_ARRAY", message)
                return None
            values.append(value)
        if not values:
            self._complain_of_nothing(key, array)
            return None
        return tuple(values)  # type: ignore[return-value]  # all are of one type

    def _complain_of_nothing(self, key: Scalar, place: Node) -> None:
        message = f"{key.text} has no value; remove it, or write '' for an empty string"
        self.complain(place, "EMPTY_VALUE", message)
