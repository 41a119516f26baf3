import pytest

from api.cli.command_line import main
from api.cli.task_command import TaskOptions
from api.client.service_client import Outcome, ServiceClient


def test_task_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[TaskOptions] = []

    def run_task(_: ServiceClient, asked: TaskOptions, __: object) -> Outcome:
        given.append(asked)
        return Outcome.FAILED

    monkeypatch.setattr("api.cli.task_command.run_task", run_task)

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

    monkeypatch.setattr("api.cli.task_command.cancel", cancel)

    assert main(["task", "--cancel", "--url", "http://robot:9000"]) == 0
    assert asked == ["http://robot:9000"]
