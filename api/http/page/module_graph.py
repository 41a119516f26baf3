"""Which modules the first use needs, in which order they run, and which come later.

The order is that of the browser: what a module imports runs before it, in the order of its imports.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

from api.http.page.module_text import Module, PageError


@dataclass(frozen=True, slots=True)
class Modules:
    """All modules that the page reaches from its entry."""

    by_path: Mapping[str, Module]
    first: tuple[Module, ...]
    """What the entry needs, in order."""
    later: Mapping[tuple[str, ...], tuple[Module, ...]]
    """What is loaded on demand, in order, by the entries that need it: who needs a module twice is
    to get the same one."""

    @classmethod
    def reached_from(cls, entry: str, read: Callable[[str], str | None]) -> "Modules":
        """Find the modules of a page.

        Args:
            entry: Path of the first one, below `web/`.
            read: Returns the source of a module by path; None: there is none.

        Raises:
            PageError: A module is missing, does not export a name, or imports itself; or it is
                imported on demand although the first use needs it.
        """
        by_path = dict(_read_all(entry, read))
        for module in by_path.values():
            _check_names(module, by_path)
        first = _in_order([entry], by_path)
        known = {module.path for module in first}
        for module in by_path.values():
            for path in known.intersection(module.later):
                raise PageError(module.path, f"web/{path} is there from the start: import it so")
        entries = sorted({path for module in by_path.values() for path in module.later})
        needs = {path: {module.path for module in _in_order([path], by_path)} for path in entries}
        later: dict[tuple[str, ...], tuple[Module, ...]] = {}
        for module in _in_order(entries, by_path):
            if module.path not in known:
                users = tuple(path for path in entries if module.path in needs[path])
                later[users] = (*later.get(users, ()), module)
        return cls(by_path, first, later)


def _read_all(entry: str, read: Callable[[str], str | None]) -> Iterator[tuple[str, Module]]:
    waiting = [(entry, entry)]
    seen = {entry}
    while waiting:
        path, by = waiting.pop()
        text = read(path)
        if text is None:
            raise PageError(by, f"there is no web/{path}")
        module = Module.read(path, text)
        yield path, module
        for other in (*(each.path for each in module.imports), *module.later):
            if other not in seen:
                seen.add(other)
                waiting.append((other, path))


def _check_names(module: Module, by_path: Mapping[str, Module]) -> None:
    for imported in module.imports:
        exports = by_path[imported.path].exports
        for name, _ in imported.names:
            if name not in exports:
                raise PageError(module.path, f"web/{imported.path} does not export {name}")


def _in_order(entries: Iterable[str], by_path: Mapping[str, Module]) -> tuple[Module, ...]:
    done: dict[str, Module] = {}
    above: list[str] = []

    def visit(path: str) -> None:
        if path in above:
            between = above[above.index(path) + 1 :]
            raise PageError(path, f"it imports itself, through {' and '.join(between) or path}")
        if path in done:
            return
        above.append(path)
        for imported in by_path[path].imports:
            visit(imported.path)
        above.pop()
        done[path] = by_path[path]

    for entry in entries:
        visit(entry)
    return tuple(done.values())
