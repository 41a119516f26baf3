import logging

import pytest

from domain.actor import Actor
from service.refused_readings import WAYS, RefusedReadings


def test_rejected_readings_are_counted_by_their_way_in(caplog: pytest.LogCaptureFixture) -> None:
    refused = RefusedReadings()
    refused.note(Actor(way="http", address="10.0.0.7"), "temperature must be a number")
    refused.note(Actor("ros"), "strength must be one of 0, 1, 2")

    assert refused.counts == {"http": 1, "ros": 1}
    assert {*refused.counts} <= {*WAYS}
    assert caplog.messages[0] == (
        "rejected a reading of http:10.0.0.7: temperature must be a number"
    )


def test_a_long_reason_is_cut(caplog: pytest.LogCaptureFixture) -> None:
    RefusedReadings().note(Actor("ros"), "x" * 10_000)

    assert len(caplog.messages[0]) < 600


def test_what_was_ignored_of_a_stop_is_logged_and_not_counted(
    caplog: pytest.LogCaptureFixture,
) -> None:
    refused = RefusedReadings()
    refused.note_ignored(Actor("ros"), "there is no field 'seq'")

    assert refused.counts == {}
    assert caplog.records[0].levelno == logging.WARNING
    assert "took a stop or hold of ros" in caplog.text
