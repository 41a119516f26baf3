"""Bundles: many modules in few files, each module with a scope of its own.

A browser opens six connections at once, and the first answer on each takes one round trip only if
it fits into what TCP sends before the first acknowledgement. So the first use needs at most six
files of at most 14 kB.
"""

import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from api.http.page.module_graph import Modules
from api.http.page.module_text import Import, Module

MOST_BYTES = 13_500
"""Of a compressed file. Ten segments of 1,460 bytes are sent at first, the headers in them."""
LEVEL = 9


def make_bundles(modules: Modules) -> tuple[list[str], dict[str, str]]:
    """Return the names of the first bundles in order, and the text of all bundles by name."""
    names = {users: _later_name(number, users) for number, users in enumerate(modules.later, 1)}
    place = {
        module.path: names[users] for users, portion in modules.later.items() for module in portion
    }
    lead = partial(_lead, place)
    scopes = {path: _scope(module, lead) for path, module in modules.by_path.items()}
    portions = pack({module.path: scopes[module.path] for module in modules.first})
    first = {f"core-{number}.js": portion for number, portion in enumerate(portions, 1)}
    place |= {path: name for name, portion in first.items() for path in portion}
    held: dict[str, list[str]] = {name: [] for name in (*first, *names.values())}
    for path, name in place.items():
        held[name].append(path)
    before = dict(zip(list(first)[1:], first, strict=False))
    texts = {
        name: _imports(name, [modules.by_path[path] for path in portion], place, before.get(name))
        + "".join(scopes[path] for path in portion)
        for name, portion in held.items()
    }
    return list(first), texts


def pack(texts: Mapping[str, str]) -> Iterator[list[str]]:
    """Yield portions of the keys, in order, whose texts together are as large as a file may be."""
    portion: list[str] = []
    packer = zlib.compressobj(LEVEL)
    size = 0
    for key, text in texts.items():
        size += len(packer.compress(text.encode()))
        if portion and size + len(packer.copy().flush()) > MOST_BYTES:
            yield portion
            portion, packer = [], zlib.compressobj(LEVEL)
            size = len(packer.compress(text.encode()))
        portion.append(key)
    yield portion


def namespace_of(path: str) -> str:
    """Return the name of the constant that holds the exports of a module: `$base$dom`."""
    return path.removeprefix("js").removesuffix(".js").replace("/", "$")


def _later_name(number: int, users: Sequence[str]) -> str:
    if len(users) == 1:
        return users[0].removeprefix("js/").replace("/", "-")
    return f"shared-{number}.js"


def _lead(place: Mapping[str, str], path: str) -> str:
    """Return an expression for a module on demand.

    Args:
        place: Bundle of each module that is loaded on demand.
        path: Of the module.
    """
    return f'import("./{place[path]}").then((made)=>made.{namespace_of(path)})'


def _scope(module: Module, lead: Callable[[str], str]) -> str:
    """Return a module as a function that runs at once and returns what the module exports."""
    bindings = [
        f"const {_pattern(imported)}={namespace_of(imported.path)};\n"
        for imported in module.imports
        if imported.binds
    ]
    return (
        f"export const {namespace_of(module.path)}=(()=>{{\n{''.join(bindings)}"
        f"{module.body_with(lead)}return{{{','.join(module.exports)}}};\n}})();\n"
    )


def _pattern(imported: Import) -> str:
    """Return what an import binds, as a pattern that takes the exports apart."""
    if imported.whole:
        return imported.whole
    pairs = (
        exported if exported == local else f"{exported}:{local}"
        for exported, local in imported.names
    )
    return f"{{{','.join(pairs)}}}"


def _imports(
    name: str, portion: Sequence[Module], place: Mapping[str, str], before: str | None
) -> str:
    """Return what a bundle imports of others.

    Args:
        name: Of the bundle.
        portion: Its modules.
        place: Bundle of each module.
        before: The bundle that has to run before; None: any order.
    """
    needed: dict[str, dict[str, None]] = {before: {}} if before else {}
    for module in portion:
        for imported in module.imports:
            if (bundle := place[imported.path]) != name:
                bound = needed.setdefault(bundle, {})
                if imported.binds:
                    bound[namespace_of(imported.path)] = None
    return "".join(
        f'import{{{",".join(namespaces)}}}from"./{bundle}";\n'
        for bundle, namespaces in needed.items()
    )
