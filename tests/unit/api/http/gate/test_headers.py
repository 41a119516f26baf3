import pytest

from api.http.gate.headers import CONTENT_SECURITY_POLICY
from tests.support.http_robot import HttpRobot


@pytest.mark.parametrize("path", ["/", "/systems", "/nope", "/systems/nobody"])
async def test_every_answer_tells_browsers_to_be_strict(path: str, robot: HttpRobot) -> None:
    headers = (await robot.http.get(path)).headers

    assert headers["content-security-policy"] == CONTENT_SECURITY_POLICY
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["cross-origin-resource-policy"] == "same-origin"
    assert "geolocation=()" in headers["permissions-policy"]


async def test_a_refusal_tells_browsers_so_too(robot: HttpRobot) -> None:
    headers = (await robot.http.get("/", headers={"host": "evil.example"})).headers

    assert headers["content-security-policy"] == CONTENT_SECURITY_POLICY
