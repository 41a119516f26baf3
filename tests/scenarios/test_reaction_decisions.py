"""The decision table of reactions: what is done about which errors, and who may say otherwise.

Each row of `tests/data/reactions/decisions.tsv` is a scenario of its own: errors come and go, an
operator requests modes and holds, rules, fallbacks and ESTOP have their say, each 2 s after the one
before. A row then says which target is in force and who set it, who holds the task, whether the
vehicle drives, how reactions stand, and which errors are announced.
"""

from collections.abc import Iterator
from http import HTTPStatus
from typing import Any, NamedTuple

import pytest

from tests.support.blocking_service import BlockingService
from tests.support.shared import PROJECT

FOLDER = PROJECT / "tests" / "data" / "reactions"
MODEL = (FOLDER / "carrier.yaml").read_text(encoding="utf-8")
PERIOD_S = 2.0
SIGNALS = ("late", "hot", "dirty", "odd", "fire", "slope")
ERRORS = {"lidar.LATE", "drive.HOT", "lidar.DIRTY", "carrier.ODD", "carrier.FIRE"}
CARRIER, LIDAR = "/systems/carrier", "/nodes/lidar"


class Row(NamedTuple):
    """One decision."""

    happens: str
    target: str
    holds: str
    drives: str
    reactions: str
    errors: str


def rows() -> list[Row]:
    lines = (FOLDER / "decisions.tsv").read_text(encoding="utf-8").splitlines()
    return [Row(*line.split("\t")) for line in lines if line and not line.startswith("#")]


def step_of(word: str) -> dict[str, Any]:
    """Return the step of one word; a `!` before it says that it is refused."""
    match word.removeprefix("!").split(":"):
        case ["FAST" | "SLOW" | "CRAWL" as mode]:
            return request("POST", f"{CARRIER}/mode", mode=mode)
        case ["activate" | "configure" | "deactivate" | "cleanup" | "shutdown" as transition]:
            return request("POST", f"{CARRIER}/state", transition=transition)
        case ["lidar", transition]:
            return request("POST", f"{LIDAR}/state", transition=transition)
        case ["drive", mode]:
            return request("POST", "/nodes/drive/mode", mode=mode)
        case ["estop" | "release" as what]:
            return request("PUT", "/emergency_stop", engaged=what == "estop", reason="test")
        case ["hold"]:
            return request("PUT", "/holds/operator", reason="test")
        case ["unhold"]:
            return {"request": {"method": "DELETE", "path": "/holds/operator"}}
        case ["free", owner]:
            return {"request": {"method": "DELETE", "path": f"/holds/reaction:{owner}"}}
        case ["seen", reaction]:
            return request("POST", f"{CARRIER}/reactions/{reaction}/acknowledge")
        case ["active" | "passive" | "disarmed" as arm, reaction]:
            return request("PATCH", f"{CARRIER}/reactions/{reaction}", arm=arm, reason="test")
        case [signal] if signal[:-1] in SIGNALS:
            bad = 20.0 if signal.startswith("slope") else 1.0
            return {"reading": {signal[:-1]: bad if signal.endswith("+") else 0.0}}
    raise AssertionError(f"no such step: {word}")


def request(method: str, path: str, **body: object) -> dict[str, Any]:
    return {"request": {"method": method, "path": path, "body": body}}


def steps_of(words: list[str]) -> Iterator[dict[str, Any]]:
    """Yield the steps: a task that lasts for longer than any row, then what happens."""
    good = {"battery_level": 1.0, "estop": False, "gps_accuracy": 100, "temperature": 30}
    calm = dict.fromkeys(SIGNALS, 0.0)
    yield {"t_s": 0, "reading": {**good, "signal_strength": "CONNECTED", **calm}}
    ahead = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(0, 201, 10)]
    yield {"t_s": 0.5, "task": {"waypoints": ahead}}
    for number, word in enumerate(words, start=1):
        yield {"t_s": number * PERIOD_S, **step_of(word)}


def decided(sample: dict[str, Any]) -> Row:
    """Return what a sample shows, in the words of the table."""
    target = sample["parts"]["carrier"]["effective_target"]
    if target is None:
        label = "none"
    else:
        label = ".".join(filter(None, (target["state"], target["mode"])))
        setter = target["reaction"] or target["rule"]
        if target["because"] != "requested":
            label += f" by {setter or target['because']}"
    stands = {
        view["reaction"]: view["state"]
        for view in sample["reactions"].values()
        if view["state"] != "idle"
    }
    told = {name: view["state"] for name, view in sample["errors"].items() if name in ERRORS}
    return Row(
        "",
        label,
        " ".join(sorted(sample["holds"])) or "-",
        "yes" if sample["vehicle"]["speed_mps"] > 0.1 else "no",
        " ".join(f"{name}:{state}" for name, state in sorted(stands.items())) or "-",
        " ".join(f"{name}:{state}" for name, state in sorted(told.items())) or "-",
    )


@pytest.fixture(scope="module")
def service() -> Iterator[BlockingService]:
    service = BlockingService()
    yield service
    service.close()


def run(service: BlockingService, happens: str) -> tuple[Row, list[str]]:
    """Return what is decided in the end, and which words were refused."""
    words = happens.split()
    until_s = (len(words) + 1) * PERIOD_S + 1
    robot = {"signals": {name: {"stale_after_s": 0} for name in SIGNALS}}
    robot["signals"]["stale_after_s"] = 0  # type: ignore[assignment]
    answer = service.post(
        "/simulations",
        {
            "model": MODEL,
            "robot": robot,
            "until_s": until_s,
            "sample_period_s": until_s,
            "steps": list(steps_of(words)),
        },
    )
    assert answer.status_code == HTTPStatus.OK, answer.text
    found = answer.json()
    refused = [words[refusal["step"] - 2].removeprefix("!") for refusal in found["refusals"]]
    return decided(found["samples"][-1]), refused


@pytest.mark.parametrize("row", rows(), ids=lambda row: row.happens)
def test_what_is_decided(service: BlockingService, row: Row) -> None:
    found, refused = run(service, row.happens)

    assert found._replace(happens=row.happens) == row
    assert refused == [w.removeprefix("!") for w in row.happens.split() if w.startswith("!")]


def test_the_table_is_large_enough() -> None:
    assert len(rows()) >= 80
    assert len({row.happens for row in rows()}) == len(rows())
