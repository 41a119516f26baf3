"""Whatever a client sends, the service goes on, and so does the connection where it can."""

import asyncio
import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from websockets.asyncio.client import ClientConnection

from tests.support.process import connect, service

_JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=20),
    lambda below: (
        st.lists(below, max_size=4) | st.dictionaries(st.text(max_size=10), below, max_size=4)
    ),
    max_leaves=10,
)
_NAMES = st.sampled_from(["battery_level", "estop", "gps_accuracy", "signal_strength", "x", ""])
_READINGS = st.fixed_dictionaries(
    {"type": st.sampled_from(["reading", "readings", "", None])},
    optional={
        "signal": _NAMES | _JSON,
        "value": _JSON,
        "stamp": _JSON,
        "source": _JSON,
        "x": _JSON,
    },
)
_TEXTS = (
    st.text(st.characters(codec="utf-8"), max_size=200)
    | st.builds(json.dumps, _JSON)
    | st.builds(json.dumps, _READINGS)
    | st.integers(1, 30_000).map(lambda depth: "[" * depth)
    | st.integers(1, 5_000).map(lambda digits: "1" * digits)
)
MESSAGES = _TEXTS | st.binary(max_size=200)

GOOD_SIGNAL = "told_from_all_others"
GOOD = json.dumps({"type": "reading", "signal": GOOD_SIGNAL, "value": 0})
"""Answered by a problem that names the signal."""


async def _bombard(batches: list[list[str | bytes]]) -> None:
    with service() as running:
        async with connect(f"{running.stream_url}?topics=events") as client:
            assert json.loads(await client.recv())["type"] == "hello"
            for batch in batches:
                for message in [*batch, GOOD]:
                    await client.send(message)
                await _read_up_to_the_answer_to_the_last(client)
        assert running.runs


async def _read_up_to_the_answer_to_the_last(client: ClientConnection) -> None:
    frame: dict[str, Any] = {}
    while GOOD_SIGNAL not in frame.get("detail", ""):
        frame = json.loads(await asyncio.wait_for(client.recv(), 10))
        assert frame["type"] in ("problem", "event")
        assert frame.get("status") != 500


def _collect(count: int) -> list[list[str | bytes]]:
    """Let hypothesis make the messages, so that one process is started for all of them."""
    found: list[list[str | bytes]] = []

    @settings(max_examples=count, database=None, suppress_health_check=list(HealthCheck))
    @given(st.lists(MESSAGES, max_size=8))
    def collect(batch: list[str | bytes]) -> None:
        found.append(batch)

    collect()
    return found


async def test_malformed_messages_end_neither_the_connection_nor_the_service() -> None:
    await _bombard(_collect(40))


@pytest.mark.soak
async def test_many_malformed_messages_end_neither_the_connection_nor_the_service() -> None:
    await _bombard(_collect(5_000))
