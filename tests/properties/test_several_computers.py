"""Whatever goes wrong between the computers of a robot: no node has two masters, no order of before
a cut is carried out after it, every stop is known, and in the end all agree on what is.

`make soak` tells 10,000 stories, `make test` 500. A story that fails is told again by its number:
`PILOTHOUSE_STORY=1234 .venv/bin/pytest tests/properties/test_several_computers.py`.
"""

import os
from collections.abc import Callable, Mapping

import pytest

from domain.devices.order_judgement import OrderJudgement
from domain.inputs import OrderReceived
from domain.link.device_facts import DeviceFacts
from domain.link.device_link import DeviceLink
from domain.link.gathering import Gathering
from domain.link.lease import Lease
from domain.link.messages import NodeOrder
from domain.link.stops import HeardStops, OwnStops
from domain.timebase import Instant
from tests.support.network_world.stories import story_of
from tests.support.network_world.told import fault_of, tell

ONE = os.environ.get("PILOTHOUSE_STORY")
SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
STORIES = [int(ONE)] if ONE else range(10_000 if SOAK else 500)


@pytest.mark.parametrize("number", STORIES)
def test_all_computers_agree_in_the_end_and_nothing_moves_by_an_old_order(number: int) -> None:
    tell(story_of(number))


def _carry_out(link: DeviceLink, order: NodeOrder, now: Instant, gathering: Gathering) -> None:
    gathering.give(OrderReceived(order.command))


FAULTS: Mapping[str, tuple[type, str, Callable[..., object]]] = {
    "a device carries out every command that arrives": (DeviceLink, "_hear_order", _carry_out),
    "a lease never ends": (Lease, "judge", lambda self, now: False),
    "nothing is waited for before a newcomer is dealt with": (
        Lease,
        "is_silent",
        lambda self, now: True,
    ),
    "no beat tells of a stop": (OwnStops, "told", lambda self, now: ()),
    "a release is never taken": (OwnStops, "take_release", lambda self, asked: ()),
    "stops of other computers are not taken in": (
        HeardStops,
        "take",
        lambda self, *told, **how: None,
    ),
    "a device does all that it is asked, also under a stop": (
        OrderJudgement,
        "refusal",
        lambda self, command: None,
    ),
    "the nodes of a lost device stay as they were": (
        DeviceFacts,
        "give_unreachable",
        lambda self, nodes, now: (),
    ),
}
"""What somebody could get wrong: whose method does something else."""


@pytest.mark.parametrize("fault", FAULTS)
def test_what_somebody_could_get_wrong_is_found(
    fault: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(*FAULTS[fault])

    assert any(isinstance(fault_of(story_of(number)), str) for number in range(100))
