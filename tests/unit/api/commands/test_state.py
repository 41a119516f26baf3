import pytest

from api.client import Outcome, ServiceClient
from api.command_line import main


def test_state_asks_for_the_transition(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def change(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.client.change", change)

    assert main(["state", "drive_base", "deactivate"]) == 0

    assert given == [("drive_base", "state", {"transition": "deactivate"}, 60.0)]
