"""Changes and plans as JSON, encoded without blocking the event loop.

A change of 10,000 nodes has 30,000 steps, whose text takes half a second.
"""

from collections.abc import Iterable
from dataclasses import replace

from pydantic import BaseModel

from api.http.list_answers import joined
from api.http.schemas.changes import ChangeJson, StepJson
from domain.snapshot import ChangeView, StepView
from service.clock import Clock

_NO_STEPS = '"steps":[]'


async def change_text(view: ChangeView, clock: Clock) -> str:
    """Return the text of a change; other tasks of the event loop run between its steps."""
    return await with_steps(ChangeJson.of(replace(view, steps=()), clock), view.steps, clock)


async def with_steps(document: BaseModel, steps: Iterable[StepView], clock: Clock) -> str:
    """Return the text of a document with steps.

    Args:
        document: Its `steps` are empty, and follow the request.
        steps: Encoded a few at a time.
        clock: Of the service.
    """
    # The last one: a parameter of the request may have this name, too.
    head, _, tail = document.model_dump_json().rpartition(_NO_STEPS)
    texts = (StepJson.of(step, clock).model_dump_json() for step in steps)
    return f'{head}"steps":[{await joined(texts)}]{tail}'
