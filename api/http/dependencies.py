"""Dependencies of routes.

All are coroutines: the framework would call plain functions in a thread.
"""

import re
from collections.abc import Collection
from itertools import islice
from typing import Annotated

from fastapi import Depends, Path, Request
from fastapi.requests import HTTPConnection

from domain.actor import Actor
from domain.errors import UnknownPartError
from domain.parts.system_model import SmhModel
from domain.state_and_mode import PartName, part_name
from service.supervisor import Supervisor
from service.worker import Jobs


async def _supervisor(connection: HTTPConnection) -> Supervisor:
    found: Supervisor = connection.app.state.supervisor
    return found


async def _worker(connection: HTTPConnection) -> Jobs:
    found: Jobs = connection.app.state.worker
    return found


SupervisorDep = Annotated[Supervisor, Depends(_supervisor)]
WorkerDep = Annotated[Jobs, Depends(_worker)]


async def _actor(request: Request) -> Actor:
    return Actor(way="http", address=request.client.host if request.client else "unknown")


ActorDep = Annotated[Actor, Depends(_actor)]
"""The client of the request."""


PartPath = Annotated[str, Path(description="Name as in the model file; it may contain slashes")]


async def _part(part: PartPath, request: Request, supervisor: SupervisorDep) -> PartName:
    """Return the part that the path names.

    Raises:
        UnknownPartError: There is no part of that name and kind; the error has a hint.
    """
    return known_part(part, request, supervisor)


def _kind(request: Request) -> str:
    return "system" if request.url.path.startswith("/systems/") else "node"


def known_of_kind(request: Request, supervisor: Supervisor) -> Collection[PartName]:
    """Return the parts of the kind that the path of a request asks for."""
    model = supervisor.model
    return model.systems.keys() if _kind(request) == "system" else model.nodes.keys()


def known_part(part: str, request: Request, supervisor: Supervisor) -> PartName:
    """Return the part that a piece of the path names.

    Raises:
        UnknownPartError: There is no part of that name and kind; the error has a hint.
    """
    if request.url.path.startswith("/devices/"):
        return _known_device(part, supervisor)
    kind, known = _kind(request), known_of_kind(request, supervisor)
    name = part_name(part)
    if name in known:
        return name
    if name in supervisor.model:
        path = request.url.path.replace(part, name, 1)
        raise UnknownPartError.of_other_kind(name, kind, _hint(supervisor.model, kind, name, path))
    hint = _hint(supervisor.model, kind, name, request.url.path)
    raise UnknownPartError(kind, name, tuple(islice(known, 21)), hint)


def _known_device(name: str, supervisor: Supervisor) -> PartName:
    """Return a device, whose errors are named as those of parts are."""
    devices = supervisor.core.devices()
    if name not in devices:
        raise UnknownPartError("device", name, tuple(devices))
    return PartName(name)


PartDep = Annotated[PartName, Depends(_part)]


_ONLY_OF_NODES = re.compile(r"/(parameters$|process$|checkpoints)(?=$|/)")

_MAX_HINTED = 256
"""Characters of a path in which the name of a part is looked for."""


def _hint(model: SmhModel, kind: str, part: str, path: str) -> str | None:
    """Return a hint: the right path of the part, or the routes of the longest known prefix."""
    if part in model:
        other = "node" if kind == "system" else "system"
        if other == "system" and (of_nodes := _ONLY_OF_NODES.search(path)) is not None:
            return f"{part} is a system, and only nodes have {of_nodes[1]}: see /systems/{part}"
        return f"{part} is a {other}: see {path.replace(f'/{kind}s/', f'/{other}s/', 1)}"
    # Each shorter prefix is looked up: in a long path that would take quadratic time.
    name = part[:_MAX_HINTED]
    while "/" in name:
        name = name.rpartition("/")[0]
        if name in model:
            more = " and parameters" if name in model.nodes else ""
            return f"there is {name}, with state, states, mode, modes, errors{more}"
    return None
