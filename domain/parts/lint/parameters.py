"""Parameters of modes that a node would not accept, or that no report ever equals."""

from collections.abc import Iterator

from domain.findings import Finding
from domain.parameters import ParameterValue, value_type
from domain.parts.lint.warning import warning
from domain.parts.system_model import NodeModel
from domain.state_and_mode import DEFAULT_MODE


def types_that_differ(node: NodeModel) -> Iterator[Finding]:
    """Yield a warning for each parameter whose type is not that in the default mode."""
    default = node.modes.get(DEFAULT_MODE, {})
    for mode, parameters in node.modes.items():
        for name, value in parameters.items():
            usual, own = value_type(default.get(name, value)), value_type(value)
            if usual != own:
                message = (
                    f"{node.name} in {mode}: {name} is {own} here and {usual} in {DEFAULT_MODE}; "
                    "a node accepts only one of these types"
                )
                yield warning("TYPE_DIFFERS", message, node.name, "modes", mode, name)


def never_inferred(node: NodeModel) -> Iterator[Finding]:
    """Yield a warning for each value that equals nothing; an inherited one is told once."""
    default = node.modes.get(DEFAULT_MODE, {})
    for mode, parameters in node.modes.items():
        for name, value in parameters.items():
            taken_over = mode != DEFAULT_MODE and default.get(name) is value
            if not taken_over and _is_never_equal(value):
                message = (
                    f"{node.name} in {mode}: {name} holds NaN, which never equals anything; "
                    "the mode is never inferred from its parameters"
                )
                yield warning("NEVER_INFERRED", message, node.name, "modes", mode, name)


def _is_never_equal(value: ParameterValue) -> bool:
    items = value if isinstance(value, tuple) else (value,)
    return any(item != item for item in items)
