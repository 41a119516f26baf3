import pytest

from api.cli.command_line import main
from api.client.service_client import Outcome, ServiceClient


def test_state_asks_for_the_transition(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def change(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.client.service_client.change", change)

    assert main(["state", "drive_base", "deactivate"]) == 0

    assert given == [("drive_base", "state", {"transition": "deactivate"}, 60.0)]
