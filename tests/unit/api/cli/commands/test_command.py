import socket
from collections.abc import Callable

import pytest

from api.cli.command_line import main
from api.client.outcomes import NoAnswerError, Outcome, ServiceProblemError
from api.client.service_client import ServiceClient
from domain.errors import StorageDegradedError

Output = pytest.CaptureFixture[str]


def test_nobody_at_the_address_ends_with_two(capsys: Output) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    url = f"http://127.0.0.1:{port}"

    assert main(["mode", "actuation", "PERFORMANCE", "--url", url]) == 2
    assert capsys.readouterr().err == (f"pilothouse: no service answers at {url}: is it running?\n")


def test_the_address_may_come_from_the_environment(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    monkeypatch.setenv("PILOTHOUSE_URL", "not-an-address")

    assert main(["state", "actuation", "activate"]) == 2
    assert "invalid address 'not-an-address'" in capsys.readouterr().err


def answer_with(monkeypatch: pytest.MonkeyPatch, ending: Callable[[], Outcome]) -> None:
    def change(client: ServiceClient, part: str, what: str, *_: object) -> Outcome:
        return ending()

    monkeypatch.setattr("api.cli.commands.change.change", change)


@pytest.mark.parametrize("outcome", list(Outcome))
def test_the_exit_code_tells_how_the_change_ended(
    monkeypatch: pytest.MonkeyPatch, outcome: Outcome
) -> None:
    answer_with(monkeypatch, lambda: outcome)

    assert main(["mode", "actuation", "PERFORMANCE"]) == int(outcome)


def test_a_refusal_ends_with_one_and_its_reasons(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    def refuse() -> Outcome:
        raise ServiceProblemError({"detail": "e-stop is pressed", "hint": "release it"})

    answer_with(monkeypatch, refuse)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 1
    assert capsys.readouterr().err == "rejected: e-stop is pressed\n  hint: release it\n"


def test_a_change_that_cannot_be_stored_is_rejected_and_nothing_was_done(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    error = StorageDegradedError("the disk is full")

    def refuse() -> Outcome:
        raise ServiceProblemError({"detail": error.message, "code": error.code, "status": 503})

    answer_with(monkeypatch, refuse)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 1
    told = "rejected: nothing was done, since it cannot be stored: the disk is full\n"
    assert capsys.readouterr().err == told


def test_a_lost_answer_ends_with_two(monkeypatch: pytest.MonkeyPatch) -> None:
    def lose() -> Outcome:
        raise NoAnswerError("no answer")

    answer_with(monkeypatch, lose)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 2


def test_a_dry_run_asks_for_the_steps_only(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def show_plan(_: ServiceClient, *asked: object) -> Outcome:
        given.append(asked[:-1])
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.cli.commands.change.show_plan", show_plan)

    assert main(["mode", "actuation", "FAST", "--dry-run"]) == 0

    assert given == [("actuation", "mode", {"mode": "FAST"}, "text")]
