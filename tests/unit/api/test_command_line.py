import socket
from collections.abc import Callable
from pathlib import Path

import pytest

from api import command_line, distribution
from api.client import NoAnswerError, Outcome, ServiceClient, ServiceProblemError
from api.command_line import main
from api.serving import EXAMPLE, ServeOptions
from api.task_command import TaskOptions

Output = pytest.CaptureFixture[str]

COMMANDS = ("serve", "check", "mode", "state", "task", "simulate")


def exit_code(*arguments: str) -> int:
    """Return the code of a command that argparse ends."""
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_without_a_command_it_says_what_there_is(capsys: Output) -> None:
    assert main([]) == 2

    told = capsys.readouterr().out
    assert [line for line in told.splitlines() if len(line) > 80] == []
    for command in COMMANDS:
        assert f"pilothouse {command} " in told


def test_it_tells_its_version(capsys: Output) -> None:
    assert exit_code("--version") == 0
    assert capsys.readouterr().out.startswith("pilothouse 0.")


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_explains_itself_in_80_columns(
    command: str, capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")

    assert exit_code(command, "--help") == 0

    told = capsys.readouterr().out
    assert "usage: pilothouse" in told
    assert [line for line in told.splitlines() if len(line) > 80] == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["serve", "--port", "65536"], "65536 is no port"),
        (["serve", "--port", "http"], "invalid"),
        (["mode", "actuation"], "MODE"),
        (["mode", "actuation", "FAST", "--wait", "nan"], "not within 0 to 3600"),
        (["mode", "actuation", "FAST", "--wait", "-1"], "not within 0 to 3600"),
        (["state", "actuation", "fly"], "invalid choice"),
        (["task"], "FILE --cancel is required"),
        (["task", "a.csv", "--cancel"], "not allowed with argument FILE"),
        (["task", "a.csv", "--heading", "up"], "invalid choice"),
        (["task", "a.csv", "--speed", "fast"], "invalid float value"),
        (["simulate"], "SCENARIO"),
        (["simulate", "a.yaml", "--format", "xml"], "invalid choice"),
        (["fly"], "invalid choice"),
    ],
)
def test_a_misspelt_command_is_told_and_ends_with_two(
    arguments: list[str], words: str, capsys: Output
) -> None:
    assert exit_code(*arguments) == 2
    assert words in capsys.readouterr().err


def test_serve_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[ServeOptions] = []
    monkeypatch.setattr("api.serving.serve", given.append)

    main(["serve", "--port", "0", "--allowed-host", "robot.local", "--allowed-host", "robot"])

    assert given == [ServeOptions(port=0, allowed_hosts=("robot.local", "robot"))]


def test_task_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[TaskOptions] = []

    def run_task(_: ServiceClient, asked: TaskOptions, __: object) -> Outcome:
        given.append(asked)
        return Outcome.FAILED

    monkeypatch.setattr("api.task_command.run_task", run_task)

    assert main(["task", "a.csv"]) == 1
    options = ["--controller", "stanley", "--speed", "1.5", "--heading", "deg"]
    main(["task", "-", *options, "--start-index", "3", "--preview", "--no-wait"])

    assert given == [
        TaskOptions("a.csv"),
        TaskOptions("-", "stanley", 1.5, "deg", 3, preview=True, wait=False),
    ]


def test_task_cancels_where_it_is_told_to(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def cancel(client: ServiceClient, _: object) -> Outcome:
        asked.append(client.url)
        return Outcome.SUCCEEDED

    monkeypatch.setattr("api.task_command.cancel", cancel)

    assert main(["task", "--cancel", "--url", "http://robot:9000"]) == 0
    assert asked == ["http://robot:9000"]


def test_simulate_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def simulate(*asked: object) -> int:
        given.append(asked)
        return 1

    monkeypatch.setattr("api.simulate_command.simulate", simulate)

    assert main(["simulate", "s.yaml"]) == 1
    assert main(["simulate", "-", "--format", "json", "--robot", "r", "--model", "m"]) == 1

    assert given == [
        ("s.yaml", "text", EXAMPLE, None, None),
        ("-", "json", EXAMPLE, Path("m"), Path("r")),
    ]


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
    assert "'not-an-address' is no address" in capsys.readouterr().err


def answer_with(monkeypatch: pytest.MonkeyPatch, ending: Callable[[], Outcome]) -> None:
    def change(client: ServiceClient, part: str, what: str, *_: object) -> Outcome:
        return ending()

    monkeypatch.setattr("api.client.change", change)


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
    assert capsys.readouterr().err == "refused: e-stop is pressed\n  hint: release it\n"


def test_a_lost_answer_ends_with_two(monkeypatch: pytest.MonkeyPatch) -> None:
    def lose() -> Outcome:
        raise NoAnswerError("no answer")

    answer_with(monkeypatch, lose)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 2


def test_ctrl_c_ends_without_a_trace(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    def interrupt() -> Outcome:
        raise KeyboardInterrupt

    answer_with(monkeypatch, interrupt)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 130
    assert capsys.readouterr() == ("", "")


def test_a_foreign_package_is_told_before_anything_is_done(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    def find_foreign() -> None:
        raise distribution.ForeignPackageError("domain", "it lies elsewhere")

    monkeypatch.setattr(command_line, "check_packages", find_foreign)

    assert main(["check", "robot.yaml"]) == 1
    told = capsys.readouterr().err
    assert "'domain'" in told
    assert "environment of its own" in told
