"""Answers that list errors."""

from collections.abc import Iterable
from functools import partial
from typing import Annotated

from fastapi import Query, Response

from api.http.error_text import error_text
from api.http.list_answers import json_list
from api.http.schemas.base import timestamp
from domain.snapshot import ErrorView
from service.supervisor import Supervisor

ActiveQuery = Annotated[
    bool | None, Query(description="true: only errors that are on; false: only the others")
]


async def answer_errors(
    supervisor: Supervisor, views: Iterable[ErrorView], active: bool | None
) -> Response:
    """Return a list of errors.

    Args:
        supervisor: Whose clock shows the times.
        views: Of the errors; consumed one by one while other tasks run.
        active: Whether only those that are on, or only the others, are asked for; None: all.
    """
    show = partial(timestamp, supervisor.clock)
    wanted = (view for view in views if active is None or view.state.is_on is active)
    return await json_list(error_text(view, show) for view in wanted)
