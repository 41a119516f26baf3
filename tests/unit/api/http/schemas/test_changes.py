"""Changes as clients see them."""

import pytest

from api.http.schemas.changes import ChangeJson, StepJson, shown_request
from domain.identifiers import ChangeId
from domain.inputs import ChangeRequest, ModeRequest, ParametersRequest, TransitionRequest
from domain.lifecycle import Transition
from domain.snapshot import ChangeStatus, ChangeView, StepStatus, StepView
from domain.state_and_mode import PartName
from domain.timebase import seconds
from tests.support.manual_clock import ManualClock

BASE = PartName("drive_base")


@pytest.mark.parametrize(
    ("request_", "shown"),
    [
        (ModeRequest(BASE, "FAST"), {"mode": "FAST"}),
        (TransitionRequest(BASE, Transition.ACTIVATE), {"transition": "activate"}),
        (ParametersRequest(BASE, {"max_speed": 0.5}), {"parameters": {"max_speed": 0.5}}),
    ],
)
def test_what_was_asked_is_shown_as_it_was_asked(
    request_: ChangeRequest, shown: dict[str, object]
) -> None:
    assert shown_request(request_) == shown


def test_a_parameter_of_several_values_is_shown_as_a_list() -> None:
    request = ParametersRequest(BASE, {"limits": (1.0, 2.0)})
    view = ChangeView(
        ChangeId("c1"), BASE, request, ChangeStatus.RUNNING, None, (), seconds(1), None, 7
    )

    text = ChangeJson.of(view, ManualClock()).model_dump_json()

    assert '"request":{"parameters":{"limits":[1.0,2.0]}}' in text
    assert '"cause":7' in text


def test_a_step_that_has_not_begun_has_no_times() -> None:
    view = StepView(BASE, "set_parameters", StepStatus.PENDING, None, None, None)

    shown = StepJson.of(view, ManualClock())

    assert (shown.action, shown.started_at, shown.ended_at) == ("set_parameters", None, None)
