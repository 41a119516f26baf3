"""How long an emergency stop takes while the service is flooded, from the flood's own address."""

import sys

import pytest

from tests.support.bench import Row, quantiles, report
from tests.support.floods.request_floods import REQUEST_FLOODS
from tests.support.floods.stops import flooding, stops
from tests.support.floods.wire_floods import WIRE_FLOODS
from tests.support.measured_service import PILOTHOUSE, MeasuredService, measured_service

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]

SECONDS = 5.0
TOKEN = "bench-token-of-24-letters"
WORST_S = 0.1


async def test_a_stop_comes_through_every_flood() -> None:
    rows: dict[str, Row] = {}
    with measured_service(PILOTHOUSE, environment={"PILOTHOUSE_TOKEN": TOKEN}) as service:
        rows["nobody (control)"] = await _row(service)
        for name in WIRE_FLOODS:
            with flooding(service.host, "tests.support.floods.wire_floods", name):
                rows[name] = await _row(service)
    report(
        "floods",
        "An emergency stop in a flood",
        f"`PUT /emergency_stop` over a new connection each time, for {SECONDS:g} s of each flood, "
        "from the address of the flood. A token is needed; the flood has none.",
        rows,
        asked=f"no stop takes more than {WORST_S * 1000:g} ms.",
    )
    assert max(row["max_ms"] for row in rows.values()) <= WORST_S * 1000


async def test_a_stop_comes_through_every_flood_of_requests() -> None:
    """Without a token, so that the requests reach their routes."""
    rows: dict[str, Row] = {}
    with measured_service(PILOTHOUSE) as service:
        rows["nobody (control)"] = await _row(service, "")
        for name in REQUEST_FLOODS:
            with flooding(service.host, "tests.support.floods.request_floods", name):
                rows[name] = await _row(service, "")
    report(
        "request-floods",
        "An emergency stop in a flood of requests",
        f"`PUT /emergency_stop` over a new connection each time, for {SECONDS:g} s of each flood, "
        "from the address of the flood; no token is needed.",
        rows,
        asked=f"no stop takes more than {WORST_S * 1000:g} ms.",
    )
    assert max(row["max_ms"] for row in rows.values()) <= WORST_S * 1000


async def _row(service: MeasuredService, token: str = TOKEN) -> Row:
    usage = service.usage
    done = await stops(service.host, SECONDS, usage.loop_cpu_s, token)
    most = round(1000 * max(stop.cpu_s for stop in done), 3)
    times = quantiles([stop.took_s for stop in done])
    return {**times, "max_cpu_ms": most, "stops": len(done), **usage.figures()}
