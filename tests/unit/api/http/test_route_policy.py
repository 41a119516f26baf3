"""What a route declares of itself."""

import pytest

from api.http.route_policy import AuditClass, Permission, RoutePolicy, policy, policy_of


def declared(permission: Permission, audit: AuditClass | None = None) -> RoutePolicy | None:
    @policy(permission, audit)
    async def route() -> None: ...

    return policy_of(route)


@pytest.mark.parametrize(
    ("permission", "audit"),
    [
        (Permission.READ_PUBLIC, AuditClass.NEVER),
        (Permission.PROBE, AuditClass.NEVER),
        (Permission.OBSERVE, AuditClass.NEVER),
        (Permission.REPORT, AuditClass.NEVER),
        (Permission.OPERATE, AuditClass.ALWAYS),
        (Permission.STOP, AuditClass.ALWAYS),
    ],
)
def test_what_changes_something_is_recorded_unless_it_is_declared_otherwise(
    permission: Permission, audit: AuditClass
) -> None:
    assert declared(permission) == RoutePolicy(permission, audit)
    assert declared(permission, AuditClass.UNLESS_DRY_RUN) == RoutePolicy(
        permission, AuditClass.UNLESS_DRY_RUN
    )


def test_who_declares_nothing_has_no_policy() -> None:
    async def route() -> None: ...

    assert policy_of(route) is None


def test_only_what_says_nothing_about_the_robot_needs_no_token() -> None:
    free = {permission for permission in Permission if not permission.needs_token}

    assert free == {Permission.READ_PUBLIC, Permission.PROBE}


def test_a_stop_and_a_reading_are_never_limited() -> None:
    unlimited = {permission for permission in Permission if not permission.is_limited}

    assert unlimited == {Permission.PROBE, Permission.REPORT, Permission.STOP}
