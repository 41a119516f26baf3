"""What a route does, declared at the route itself.

Whether it needs the token, how often it may be asked and whether it is recorded follow from that;
the gates read it, so that no path is named twice.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, TypeVar

_ATTRIBUTE = "__pilothouse_policy__"

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])


class Permission(Enum):
    """What a client must be permitted to do in order to use a route."""

    READ_PUBLIC = auto()
    """Read what is the same for every robot: the page and the documents. It needs no token."""
    PROBE = auto()
    """Ask on behalf of who restarts the service. It needs no token, and is never limited."""
    OBSERVE = auto()
    """Look at the robot, or calculate; nothing changes."""
    REPORT = auto()
    """Hand in readings. Never limited, since one may be that of a stop button."""
    OPERATE = auto()
    """Change what the robot does."""
    STOP = auto()
    """Make the robot safe. Never limited: who cannot press the stop because somebody behind the
    same address asks too much would be worse off than with no limit."""

    @property
    def needs_token(self) -> bool:
        """Tell whether the token of the service has to be given, where it has one."""
        return self not in (Permission.READ_PUBLIC, Permission.PROBE)

    @property
    def is_limited(self) -> bool:
        """Tell whether it counts how often a client asks."""
        return self not in (Permission.PROBE, Permission.REPORT, Permission.STOP)


class AuditClass(Enum):
    """Whether a request is recorded as an event, with who asked and how it was answered."""

    NEVER = auto()
    """It changes nothing; or what it reports may come a hundred times a second, and has events of
    its own when it matters."""
    ALWAYS = auto()
    UNLESS_DRY_RUN = auto()
    """With `?dry_run=true` it changes nothing; elsewhere the word means nothing, and hides nothing.
    """


_CHANGING = (Permission.OPERATE, Permission.STOP)


@dataclass(frozen=True, slots=True)
class RoutePolicy:
    """What is declared of a route."""

    permission: Permission
    audit: AuditClass


class UndeclaredRouteError(LookupError):
    """A route that does not say what it does."""

    def __init__(self, path: str) -> None:
        super().__init__(f"the route {path} declares no policy: see api.http.route_policy")


def policy(
    permission: Permission, audit: AuditClass | None = None
) -> Callable[[Endpoint], Endpoint]:
    """Declare what a route does; to be written right above its function.

    Args:
        permission: What a client must be permitted to do.
        audit: Whether requests are recorded; None: those that change something always are, and
            others never.
    """
    if audit is None:
        audit = AuditClass.ALWAYS if permission in _CHANGING else AuditClass.NEVER
    declared = RoutePolicy(permission, audit)

    def declare(endpoint: Endpoint) -> Endpoint:
        setattr(endpoint, _ATTRIBUTE, declared)
        return endpoint

    return declare


def policy_of(endpoint: object) -> RoutePolicy | None:
    """Return what is declared of the function of a route; None: nothing."""
    found: RoutePolicy | None = getattr(endpoint, _ATTRIBUTE, None)
    return found
