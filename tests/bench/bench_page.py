"""What the monitor page takes: time until it can be used, and what drawing it costs.

With `PILOTHOUSE_BEFORE=FOLDER`, a checkout of an earlier commit, each figure is measured for that
page as well, in the same run: `git worktree add build/before COMMIT`.
"""

import json
import os
import sys
import urllib.request
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from tests.browser.station import CHROMIUM
from tests.support.bench import Row, report
from tests.support.big_model import big_model_text
from tests.support.measured_service import (
    PILOTHOUSE,
    MeasuredService,
    measured_service,
    module,
)
from tests.support.page_bench.opened import OpenedPage, opened
from tests.support.page_bench.relay import Relay, relayed

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(not CHROMIUM.exists(), reason=f"there is no {CHROMIUM}"),
]

ROUND_TRIP_S = 0.15
ROUNDS = 5
SETTLE_S = 5.0
SECONDS = 10.0
NODES = 900
"""With the systems above them, 1,000 parts."""
STOP = "ph-stop-button button"
MODE = "ph-mode-switcher button:not([disabled])"


@dataclass(frozen=True, slots=True)
class _Version:
    """One version of Pilothouse."""

    command: tuple[str, ...]
    environment: Mapping[str, str]


def _versions() -> dict[str, _Version]:
    """Return the versions to compare, by the name of their columns."""
    versions = {"now": _Version(PILOTHOUSE, {})}
    folder = os.environ.get("PILOTHOUSE_BEFORE")
    if folder is not None:
        main = "import sys; from api.cli.command_line import main; sys.exit(main())"
        # -P: not the folder in which it runs.
        command = (sys.executable, "-P", "-c", main, "serve", "--port", "0")
        environment = {"PYTHONPATH": str(Path(folder).resolve())}
        versions = {"before": _Version(command, environment), **versions}
    return versions


NOTES = [] if "PILOTHOUSE_BEFORE" in os.environ else ["Only the page of now was measured."]


@pytest.mark.timeout(900)
def test_how_soon_the_page_can_be_used(tmp_path: Path) -> None:
    model = _large_model(tmp_path)
    rows = {
        f"{robot}, {way}": _per_version(arguments, _soon(round_trip_s))
        for robot, arguments in {"example": (), "1,000 parts": (model,)}.items()
        for way, round_trip_s in {"no delay": 0.0, "150 ms": ROUND_TRIP_S}.items()
    }
    report(
        "page_start",
        "How soon the page can be used",
        f"From the navigation of a headless Chromium without a cache, median of {ROUNDS}. "
        "`usable`: the header tells the state of the robot and STOP can be pressed; `drawn`: parts "
        "are listed as well. The delay is that of a relay of ours, which passes on all bytes 75 ms "
        "later and "
        "lets each connection wait for a round trip; `STOP` and `mode` are the times from a click "
        "on that button to the frame in which it has changed.",
        rows,
        asked="with 150 ms, usable within 1.0 s and each click heard within 100 ms; 1,000 parts "
        "drawn within 1.0 s.",
        notes=NOTES,
    )


@pytest.mark.timeout(900)
def test_what_drawing_costs(tmp_path: Path) -> None:
    model = _large_model(tmp_path)
    rows = {
        "example, at rest": _per_version((), _cost()),
        "example, driving": _per_version((), _cost(_drive)),
        "1,000 parts, at rest": _per_version((model,), _cost()),
        "1,000 parts, 200 signals, changing": _per_version((model,), _cost_of_changes),
    }
    report(
        "page_cost",
        "What drawing the page costs",
        f"CPU of the renderer and of the GPU process of a headless Chromium at 1440 by 900, over "
        f"{SECONDS:g} s, as the share of a core. Changing: a stand-in for the service tells 5 % of "
        "the parts and of the signals anew every 50 ms. `frames` are those that arrived.",
        rows,
        asked="at rest at most 6 %, driving at most 25 %, changing at most 50 %.",
        notes=NOTES,
    )


Measure = Callable[[MeasuredService], Row]


def _per_version(arguments: Sequence[str], measure: Measure) -> Row:
    """Return a row with the columns of each version."""
    row: dict[str, float] = {}
    for name, version in _versions().items():
        command = (*version.command, *arguments)
        with measured_service(command, environment=version.environment) as service:
            figures = measure(service)
        row |= {f"{name}_{column}": value for column, value in figures.items()}
    return row


def _soon(round_trip_s: float) -> Measure:
    def measure(service: MeasuredService) -> Row:
        rounds = [_opened_once(service, round_trip_s) for _ in range(ROUNDS)]
        columns = dict.fromkeys(column for each in rounds for column in each)
        return {
            column: round(median(each[column] for each in rounds if column in each), 3)
            for column in columns
        }

    return measure


def _opened_once(service: MeasuredService, round_trip_s: float) -> Row:
    with _relayed(service, round_trip_s) as url, opened(url) as page:
        figures = {"usable_s": page.usable_s(), "drawn_s": page.drawn_s()}
        page.page.wait_for_selector(MODE, state="attached", timeout=60_000)
        figures["mode_ms"] = 1000 * page.heard_s(MODE)
        figures["STOP_ms"] = 1000 * page.heard_s(STOP)
    _send(service, "PUT", "/emergency_stop", {"engaged": False, "reason": "bench"})
    return figures


def _cost(begin: Callable[[MeasuredService], None] = lambda _: None) -> Measure:
    def measure(service: MeasuredService) -> Row:
        with opened(service.process.url) as page:
            return _settled_cost(page, lambda: begin(service))

    return measure


def _cost_of_changes(service: MeasuredService) -> Row:
    port = service.host.rpartition(":")[2]
    frames = module("tests.support.page_bench.frame_server", port)
    with measured_service(frames) as stream:
        stream_port = int(stream.host.rpartition(":")[2])
        relay = Relay(int(port), stream_port=stream_port)
        with relayed(relay) as url, opened(url) as page:
            return _settled_cost(page, lambda: None)


def _settled_cost(page: OpenedPage, begin: Callable[[], None]) -> Row:
    page.drawn_s()
    begin()
    page.page.wait_for_timeout(1000 * SETTLE_S)
    return page.cost(SECONDS)


@contextmanager
def _relayed(service: MeasuredService, round_trip_s: float) -> Iterator[str]:
    if not round_trip_s:
        yield service.process.url
        return
    with relayed(Relay(int(service.host.rpartition(":")[2]), round_trip_s)) as url:
        yield url


def _large_model(folder: Path) -> str:
    path = folder / "large.yaml"
    path.write_text(big_model_text(NODES), encoding="utf-8")
    return str(path)


def _drive(service: MeasuredService) -> None:
    """Start a task that lasts longer than the measurement, where the vehicle stands."""
    with urllib.request.urlopen(f"{service.process.url}/vehicle") as answer:
        pose = json.load(answer)["pose"]
    ahead = [{**pose, "x_m": pose["x_m"] + 2.0 * n, "yaw_rad": 0.0} for n in range(60)]
    _send(service, "POST", "/tasks", {"waypoints": ahead, "speed_mps": 2.8})


def _send(service: MeasuredService, method: str, path: str, body: object) -> None:
    request = urllib.request.Request(
        f"{service.process.url}{path}", json.dumps(body).encode(), method=method
    )
    request.add_header("Content-Type", "application/json")
    urllib.request.urlopen(request).close()
