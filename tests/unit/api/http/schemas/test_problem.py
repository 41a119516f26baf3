import json

from api.http.schemas.problem import Problem


def test_members_that_do_not_apply_are_left_out() -> None:
    problem = Problem(
        type="urn:pilothouse:problem:refused",
        title="Refused",
        status=409,
        detail="it is so",
        instance="/x",
        code="REFUSED",
        hint="ask later",
    )

    found = json.loads(problem.as_json())

    assert set(found) == {"type", "title", "status", "detail", "instance", "code", "hint"}
