"""How long requests take, beside the least that the same web server and framework can do."""

from pathlib import Path

import pytest

from tests.support.asker import Asker, asking
from tests.support.bench import quantiles, report
from tests.support.measured_service import PILOTHOUSE, measured_service, module

pytestmark = pytest.mark.bench

ROUNDS = 500
CHANGES = 100
NODE = "{configure_s: 0, activate_s: 0, deactivate_s: 0, set_parameters_s: 0}"
ROBOT = f"nodes: {{drive_base: {NODE}, manipulator: {NODE}}}\n"
"""Nodes that obey at once, so that what is left is ours."""
MODES = ("PERFORMANCE", "MODERATE")
LEVELS = (0.9, 0.8)
"""Another one each time, and none of them an error."""


async def test_how_long_requests_take(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(ROBOT)
    ours = (*PILOTHOUSE, "--robot", str(robot))
    with (
        measured_service(ours) as service,
        measured_service(module("tests.support.echo_app")) as echo,
    ):
        async with asking(service.host) as asker, asking(echo.host) as control:
            times = await _times(asker, control)
    report(
        "requests",
        "Requests",
        f"From sending a request to the head of its response, {ROUNDS} times each in turn over one "
        f"connection, with an idle FastAPI service as reference; {CHANGES} changes between two "
        "modes of a system whose two nodes respond at once, until the change has succeeded.",
        {name: quantiles(taken) for name, taken in times.items()},
    )


async def _times(asker: Asker, control: Asker) -> dict[str, list[float]]:
    """Return what requests took, s."""
    times: dict[str, list[float]] = {}
    for number in range(ROUNDS):
        body = f'{{"value": {LEVELS[number % 2]}}}'
        asked = {
            "FastAPI alone: GET": (control, "GET /livez", ""),
            "FastAPI alone: POST": (control, "POST /echo", body),
            "GET /livez": (asker, "GET /livez", ""),
            "GET /systems/actuation": (asker, "GET /systems/actuation", ""),
            "POST /signals/battery_level": (asker, "POST /signals/battery_level", body),
        }
        if number < CHANGES:
            mode = f'{{"mode": "{MODES[number % 2]}"}}'
            request = "POST /systems/actuation/mode?wait=5"
            asked[request] = (asker, request, mode)
        for name, (who, request, content) in asked.items():
            times.setdefault(name, []).append((await who.ask(request, content))[1])
    return times
