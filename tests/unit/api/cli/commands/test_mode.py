import pytest

from api.cli.command_line import main
from api.client.service_client import Outcome, ServiceClient


def test_mode_asks_for_the_mode_and_waits_as_long_as_it_was_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: list[tuple[object, ...]] = []

    def change(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.client.service_client.change", change)

    assert main(["mode", "actuation", "FAST"]) == 0
    main(["mode", "actuation", "SLOW", "--wait", "1.5"])

    assert given == [
        ("actuation", "mode", {"mode": "FAST"}, 60.0),
        ("actuation", "mode", {"mode": "SLOW"}, 1.5),
    ]
