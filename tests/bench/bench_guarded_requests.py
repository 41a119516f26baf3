"""How long a request for a mode of all nodes holds the core and the event loop.

A robot without guards and orders is measured beside one in which every part has them.
"""

import asyncio
import gc
import json
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from domain.inputs import (
    CancelRequest,
    Input,
    ModeRequest,
    NodeReport,
    Reading,
    Readings,
    TimePassed,
)
from domain.lifecycle import LifecycleState
from domain.state_and_mode import DEFAULT_MODE
from domain.supervision import Supervision, SupervisionSettings
from service.files.model_file import read_model
from tests.support.asker import asking
from tests.support.bench import Row, report
from tests.support.big_model import FAST, PARAMETERS, SLOW, big_model_text
from tests.support.good import GOOD
from tests.support.guarded_model_text import guarded_model_text
from tests.support.measured_service import PILOTHOUSE, measured_service

pytestmark = pytest.mark.bench

SIZES = (1_000, 10_000)
ROUNDS = 5


def _guarded(nodes: int) -> str:
    """Return a model in which every mode of every part has guards."""
    return guarded_model_text(nodes).replace(
        "FAST:\n        requires", "__ALL__:\n        requires"
    )


TEXTS = {"": big_model_text, ", guarded and ordered": _guarded}
LARGEST_HOLD_MS: Mapping[int, float] = {1_000: 10, 10_000: 50}
SETTLE_S = 1.0
BETWEEN_S = 0.001
STEP_S = 30.0
"""Longer than the bench: nodes that obey would be measured, too."""


@pytest.mark.timeout(300)
def test_how_long_a_request_holds_the_core() -> None:
    rows = {
        f"{nodes:,} nodes{kind}": _holds(text(nodes))
        for nodes in SIZES
        for kind, text in TEXTS.items()
    }
    report(
        "guarded_requests",
        "A request for a mode of all nodes",
        "`request`: the turn of the core that takes it. `turn`: the longest one in which it goes "
        "on, until all nodes are asked that may be. `dry run`: its plan alone. Each the best of "
        f"{ROUNDS}, of the process's CPU time. Guarded and ordered: every part has three "
        "conditions and a fallback, and in every system the last part waits for the first.",
        rows,
        asked="a request for 1,000 nodes below 10 ms, for 10,000 nodes below 50 ms, and a dry run "
        "for 1,000 nodes below 20 ms, with guards and order.",
    )
    for nodes, most_ms in LARGEST_HOLD_MS.items():
        for kind in TEXTS:
            assert rows[f"{nodes:,} nodes{kind}"]["request_ms"] < most_ms


@pytest.mark.timeout(600)
async def test_how_long_a_request_holds_the_event_loop(tmp_path: Path) -> None:
    rows: dict[str, Row] = {}
    for nodes in SIZES:
        for number, (kind, text) in enumerate(TEXTS.items()):
            model, robot = tmp_path / f"{nodes}_{number}.yaml", tmp_path / f"{nodes}_robot.yaml"
            model.write_text(text(nodes))
            robot.write_text(_slow_robot(nodes))
            root = read_model(text(nodes)).model.parts[0]
            command = (*PILOTHOUSE, "--data", ":memory:", str(model), "--robot", str(robot))
            with measured_service(command) as service:
                await _until_all_are_known(service.host, root)
                held = [await _held(service.host, root, (FAST, SLOW)[n % 2]) for n in range(ROUNDS)]
            rows[f"{nodes:,} nodes{kind}"] = {
                "answer_ms": round(1000 * min(answer for answer, _ in held), 1),
                "hold_ms": round(1000 * min(hold for _, hold in held), 1),
            }
    report(
        "guarded_requests_service",
        "A request for a mode of all nodes, seen from outside",
        "`answer`: to POST mode. `hold`: the longest answer to GET /livez meanwhile, asked every "
        f"{1000 * BETWEEN_S:g} ms over another connection. Each the best of {ROUNDS}; nodes are "
        "simulated, and take longer for a step than this bench.",
        rows,
        asked="hold: 1,000 nodes below 10 ms, 10,000 nodes below 50 ms, with guards and order.",
    )


def _holds(text: str) -> Row:
    core = Supervision(read_model(text).model, SupervisionSettings(), 0)
    root = core.model.parts[0]
    for node in core.model.nodes:
        parameters = PARAMETERS[DEFAULT_MODE]
        core.handle(NodeReport(node, LifecycleState.INACTIVE, parameters=parameters), 0)
    good = tuple(Reading(signal, value=value) for signal, value in GOOD.items())
    core.handle(Readings(good, "bench"), 0)
    requests, turns, plans = [], [], []
    with _quiet():
        for number in range(ROUNDS):
            request = ModeRequest(root, (FAST, SLOW)[number % 2])
            begin = time.process_time()
            core.plan(request)
            plans.append(time.process_time() - begin)
            requests.append(_turn(core, request))
            turns.append(max(_turns(core), default=0.0))
            core.handle(CancelRequest(core.changes(1)[0].id), 0)
            for _ in _turns(core):
                pass
    return {
        "request_ms": round(1000 * min(requests), 1),
        "turn_ms": round(1000 * min(turns), 1),
        "dry_run_ms": round(1000 * min(plans), 1),
    }


def _turn(core: Supervision, given: Input) -> float:
    """Let the core take an input; return the CPU time of that, s."""
    begin = time.process_time()
    core.handle(given, 0)
    return time.process_time() - begin


def _turns(core: Supervision) -> Iterator[float]:
    """Let the core go on as long as there is more to do at once; yield what each turn takes."""
    while core.wake_at() == 0:
        yield _turn(core, TimePassed())


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep Python's garbage collection away, as the service does while it handles an input."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


async def _until_all_are_known(host: str, root: str) -> None:
    """Wait until every node has reported; those of a large robot take many turns."""
    async with httpx.AsyncClient(base_url=f"http://{host}") as client:
        while True:
            part = (await client.get(f"/systems/{root}")).json()
            if part["actual"]["state"] != LifecycleState.UNKNOWN:
                return
            await asyncio.sleep(SETTLE_S)


async def _held(host: str, root: str, mode: str) -> tuple[float, float]:
    """Return how long the answer to a request took, and the longest one to others meanwhile."""
    async with asking(host) as asker, asking(host) as other:
        for signal, value in GOOD.items():
            await asker.ask(f"POST /signals/{signal}", json.dumps({"value": value}))
        requested = asyncio.create_task(
            asker.ask(f"POST /systems/{root}/mode", json.dumps({"mode": mode}))
        )
        longest = 0.0
        while not requested.done():
            longest = max(longest, (await other.ask("GET /livez"))[1])
            await asyncio.sleep(BETWEEN_S)
        _, took = await requested
    return took, longest


def _slow_robot(nodes: int) -> str:
    step = ", ".join(f"{name}_s: {STEP_S}" for name in ("configure", "activate", "set_parameters"))
    names = (f"node_{number}" for number in range(nodes))
    return "\n".join(["nodes:", *(f"  {name}: {{{step}}}" for name in names), ""])
