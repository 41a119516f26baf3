"""Errors as text: valid by `ErrorJson`, whatever they are called and whatever was found."""

import json
from functools import partial

from hypothesis import given
from hypothesis import strategies as st

from api.http.error_text import error_text
from api.http.schemas.base import timestamp
from api.http.schemas.errors import ErrorJson
from domain.health.built_in_errors import OF_NODES
from domain.snapshot import ErrorKey, ErrorState, ErrorView, Severity
from domain.state_and_mode import PartName
from tests.support.manual_clock import ManualClock

CLOCK = ManualClock()

words = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
facts = st.none() | st.booleans() | st.integers(-9, 9) | st.floats(allow_nan=False) | words
views = st.builds(
    ErrorView,
    key=st.builds(ErrorKey, st.none() | words.map(PartName), st.sampled_from(list(OF_NODES))),
    severity=st.sampled_from(Severity),
    state=st.sampled_from(ErrorState),
    first_out=st.booleans(),
    message=words,
    value=facts,
    threshold=facts,
    since=st.none() | st.integers(0, 10**15),
    count=st.integers(0, 9),
)


def shown(view: ErrorView) -> str:
    return error_text(view, partial(timestamp, CLOCK))


@given(views)
def test_an_error_has_all_members_of_its_message_in_their_order(view: ErrorView) -> None:
    text = shown(view)
    message = ErrorJson.model_validate_json(text)
    assert list(json.loads(text)) == list(ErrorJson.model_fields)
    assert (message.part, message.error) == view.key
    assert (message.severity, message.state) == (view.severity, view.state)
    assert (message.since_at is None) is (view.since is None)
    assert [(root.part, root.error) for root in message.roots] == [view.key]


def test_a_value_that_json_cannot_hold_is_null() -> None:
    key = ErrorKey(PartName("arm"), "PARAMETERS_DRIFTED")
    nan, warning = float("nan"), Severity.WARNING
    view = ErrorView(key, warning, ErrorState.ACTIVE, False, "gain is nan", nan, 0.5, 7, 1)
    assert json.loads(shown(view))["value"] is None
