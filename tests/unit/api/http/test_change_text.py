"""Large changes are encoded a few steps at a time, and read as if at once."""

import asyncio
import json

from api.http.change_text import change_text
from api.http.schemas.changes import ChangeJson
from domain.identifiers import ChangeId
from domain.inputs import ParametersRequest
from domain.lifecycle import Transition
from domain.snapshot import ChangeStatus, ChangeView, StepStatus, StepView
from domain.state_and_mode import PartName
from tests.support.manual_clock import ManualClock

STEP = StepView(
    PartName("arm"), Transition.CONFIGURE, StepStatus.FAILED, 1, None, 'went "steps":[]'
)


def changed(steps: int) -> ChangeView:
    """Return a change whose parameters and errors look like what surrounds steps."""
    asked = ParametersRequest(PartName("arm"), {"steps": ()})
    status, reason = ChangeStatus.RUNNING, '"steps":[]'
    return ChangeView(
        ChangeId("c1"), PartName("arm"), asked, status, reason, (STEP,) * steps, 1, None, 7
    )


async def test_the_text_is_that_of_the_whole_change() -> None:
    clock = ManualClock()
    for steps in (0, 1, 2_000):
        text = await change_text(changed(steps), clock)
        assert json.loads(text) == json.loads(
            ChangeJson.of(changed(steps), clock).model_dump_json()
        )


async def test_others_have_their_turn_while_a_large_change_is_encoded() -> None:
    turns = 0

    async def others() -> None:
        nonlocal turns
        while True:
            turns += 1
            await asyncio.sleep(0)

    beside = asyncio.create_task(others())
    text = await change_text(changed(30_000), ManualClock())
    beside.cancel()
    assert turns >= len(text) // 40_000
