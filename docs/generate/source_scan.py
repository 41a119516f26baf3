"""Scan the source for literals that are codes or names of metrics."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]

_CODE = re.compile(r"[A-Z]+(?:_[A-Z]+)*")


class UndescribedError(Exception):
    """A name in the source has no description, or a description has no name in the source."""

    def __init__(self, what: str, unknown: set[str], gone: set[str]) -> None:
        super().__init__(
            f"{what}: describe {sorted(unknown) or 'nothing'}, remove {sorted(gone) or 'nothing'}"
        )


def require_described(what: str, in_source: set[str], described: set[str]) -> None:
    """Compare the names in the source with those that are described.

    Raises:
        UndescribedError: They differ.
    """
    if in_source != described:
        raise UndescribedError(what, in_source - described, described - in_source)


def metric_names() -> set[str]:
    """Return the metric names that occur as literals in api."""
    found = {text for tree in trees("api") for text in _texts(tree)}
    return {text for text in found if re.fullmatch(r"pilothouse_[a-z_]+", text)}


def codes_in(module: str) -> set[str]:
    """Return the codes that occur as literals in a module.

    Args:
        module: Its file, such as `domain/changes/admission.py`.
    """
    tree = ast.parse((PROJECT / module).read_text(encoding="utf-8"))
    return {text for text in _texts(tree) if _CODE.fullmatch(text)}


def codes_given_to(*callables: str) -> set[str]:
    """Return the codes that are passed as literal arguments to calls in api.

    Args:
        callables: Names of the called functions. An argument may also be a constant of the module.
    """
    codes: set[str] = set()
    for tree in trees("api"):
        constants = dict(_constants(tree))
        for call in ast.walk(tree):
            if isinstance(call, ast.Call) and _name(call.func) in callables:
                arguments = [*call.args, *(keyword.value for keyword in call.keywords)]
                codes |= {text for text in _values(arguments, constants) if _CODE.fullmatch(text)}
    return codes


def trees(*folders: str) -> Iterator[ast.Module]:
    """Yield the syntax trees of all modules in some folders."""
    for folder in folders:
        for path in sorted((PROJECT / folder).rglob("*.py")):
            yield ast.parse(path.read_text(encoding="utf-8"))


def _texts(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def _constants(tree: ast.Module) -> Iterator[tuple[str, str]]:
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            for target in node.targets:
                if isinstance(target, ast.Name) and isinstance(node.value.value, str):
                    yield target.id, node.value.value


def _values(arguments: list[ast.expr], constants: dict[str, str]) -> Iterator[str]:
    for argument in arguments:
        if isinstance(argument, ast.Constant) and isinstance(argument.value, str):
            yield argument.value
        elif isinstance(argument, ast.Name) and argument.id in constants:
            yield constants[argument.id]


def _name(function: ast.expr) -> str:
    return function.id if isinstance(function, ast.Name) else ""
