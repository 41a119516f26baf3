"""The policy of a route: its permission and audit class, declared at the route itself.

They determine whether a request needs the token, is rate-limited, and is recorded. The gates read
them here, so that no path is listed twice.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any, TypeVar

_ATTRIBUTE = "__pilothouse_policy__"

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])


class Permission(Enum):
    """The permission that a client needs for a route."""

    READ_PUBLIC = auto()
    """Read what is the same for every robot: the page and the documents. Needs no token. Where no
    token is set, the page holds the newest frame as well."""
    PROBE = auto()
    """Liveness and readiness probes of a service manager. Needs no token; never limited."""
    OBSERVE = auto()
    """Read the state of the robot, or calculate; nothing changes."""
    REPORT = auto()
    """Submit readings. Never limited, since one may be that of a stop button."""
    OPERATE = auto()
    """Change what the robot does."""
    STOP = auto()
    """Make the robot safe. Never limited: other clients at the same address must not be able to
    block a stop."""

    @property
    def needs_token(self) -> bool:
        """Tell whether the token is required, if the service has one."""
        return self not in (Permission.READ_PUBLIC, Permission.PROBE)

    @property
    def writes(self) -> bool:
        """Tell whether requests may change something."""
        return self in (Permission.REPORT, Permission.OPERATE, Permission.STOP)

    @property
    def is_limited(self) -> bool:
        """Tell whether requests are rate-limited."""
        return self not in (Permission.PROBE, Permission.REPORT, Permission.STOP)


class AuditClass(Enum):
    """Whether a request is recorded as an event, with its client and status."""

    NEVER = auto()
    """It changes nothing; or it is a reading, which may come a hundred times a second and has its
    own events when it matters."""
    ALWAYS = auto()
    UNLESS_DRY_RUN = auto()
    """Not recorded with `?dry_run=true`, since then it changes nothing. Other routes do not
    know this field, so there it cannot hide a request."""


_CHANGING = (Permission.OPERATE, Permission.STOP)


@dataclass(frozen=True, slots=True)
class RoutePolicy:
    """The declared policy of a route."""

    permission: Permission
    audit: AuditClass


class UndeclaredRouteError(LookupError):
    """A route without a policy."""

    def __init__(self, path: str) -> None:
        super().__init__(f"the route {path} declares no policy: see api.http.route_policy")


def policy(
    permission: Permission, audit: AuditClass | None = None
) -> Callable[[Endpoint], Endpoint]:
    """Declare the policy of a route; the innermost decorator of its function.

    Args:
        permission: Needed by the client.
        audit: Whether requests are recorded; None: always if they change something, else never.
    """
    if audit is None:
        audit = AuditClass.ALWAYS if permission in _CHANGING else AuditClass.NEVER
    declared = RoutePolicy(permission, audit)

    def declare(endpoint: Endpoint) -> Endpoint:
        setattr(endpoint, _ATTRIBUTE, declared)
        return endpoint

    return declare


def policy_of(endpoint: object) -> RoutePolicy | None:
    """Return the policy of the function of a route; None: none is declared."""
    found: RoutePolicy | None = getattr(endpoint, _ATTRIBUTE, None)
    return found
