"""What a controller says, and the deadlines that it has without settings."""

from domain.controller import ControllerSettings, GoalOutcome
from domain.timebase import seconds


def test_a_controller_has_a_second_for_what_it_does_at_once() -> None:
    settings = ControllerSettings("/navigate_waypoints")

    at_once = {settings.accepted_within, settings.silent_for, settings.taken_back_within}
    assert at_once == {seconds(1.0)}
    assert settings.stands_within > seconds(1.0), "a vehicle needs time to brake"


def test_ends_are_written_in_records_as_words() -> None:
    assert [str(end) for end in GoalOutcome] == ["succeeded", "aborted", "canceled", "unknown"]
