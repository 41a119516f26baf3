"""Whatever goes wrong between the computers of a robot: no node has two masters, no order of before
a cut is carried out after it, every stop is known, and in the end all agree on what is.

`make soak` tells 10,000 stories, `make test` 500. A story that fails is told again by its number:
`PILOTHOUSE_STORY=1234 .venv/bin/pytest tests/properties/test_several_computers.py`.
"""

import os
from collections.abc import Callable

import pytest

from domain.devices.order_judgement import OrderJudgement
from domain.link.device_facts import DeviceFacts
from domain.link.lease import Lease
from domain.link.orders import Orders
from domain.link.peer import Peer
from domain.link.stops import HeardStops, OwnStops
from tests.support.network_world.stories import story_of
from tests.support.network_world.told import fault_of, tell

ONE = os.environ.get("PILOTHOUSE_STORY")
SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
STORIES = [int(ONE)] if ONE else range(10_000 if SOAK else 500)


@pytest.mark.parametrize("number", STORIES)
def test_all_computers_agree_in_the_end_and_nothing_moves_by_an_old_order(number: int) -> None:
    tell(story_of(number))


FAULTS: dict[str, tuple[type, str, Callable[..., object]]] = {
    "a device carries out what was sent before a loss": (
        Orders,
        "find_refusal",
        lambda self, order, session: None,
    ),
    "an order is carried out as often as it arrives": (Orders, "is_next", lambda self, order: True),
    "a lease never ends": (Lease, "judge", lambda self, now: False),
    "a newcomer is dealt with at once": (Lease, "is_silent", lambda self, now: True),
    "no beat tells of a stop": (OwnStops, "told", lambda self, now: ()),
    "a release is never taken": (OwnStops, "take_release", lambda self, asked: ()),
    "a stop of another computer is not taken in": (
        HeardStops,
        "take",
        lambda self, *args, **kwargs: None,
    ),
    "a device activates under a stop": (OrderJudgement, "refusal", lambda self, command: None),
    "the nodes of a lost device stay as they were": (
        DeviceFacts,
        "give_unreachable",
        lambda self, nodes, now: (),
    ),
    "what was missed during a loss is never told": (DeviceFacts, "give_all", lambda self, now: ()),
    "what another one does not acknowledge": (Peer, "_lives", lambda self, beat, now: False),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(*FAULTS[fault])

    found = (number for number in range(200) if isinstance(fault_of(story_of(number)), str))

    assert next(found, None) is not None, f"no story tells that {fault}"
