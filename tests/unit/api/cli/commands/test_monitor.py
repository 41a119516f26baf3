import pytest

from api.cli.command_line import main
from api.client.outcomes import NoAnswerError, ServiceProblemError

Output = pytest.CaptureFixture[str]


def test_monitor_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[str, str, bool]] = []

    def monitor(url: str, form: str, *, once: bool) -> int:
        given.append((url, form, once))
        return 0

    monkeypatch.setattr("api.cli.monitor.monitor.monitor", monitor)
    monkeypatch.delenv("PILOTHOUSE_URL", raising=False)

    assert main(["monitor"]) == 0
    main(["monitor", "http://robot:9000", "--once", "--format", "json"])
    monkeypatch.setenv("PILOTHOUSE_URL", "http://other:8000")
    main(["monitor"])
    main(["monitor", "--url", "http://third:8000"])

    assert given == [
        ("http://127.0.0.1:8000", "text", False),
        ("http://robot:9000", "json", True),
        ("http://other:8000", "text", False),
        ("http://third:8000", "text", False),
    ]


def test_monitor_over_ros_needs_a_model_and_no_service(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    given: list[tuple[str, str, bool]] = []

    def ros_monitor(path: str, form: str, *, once: bool) -> int:
        given.append((path, form, once))
        return 0

    monkeypatch.setattr("api.cli.ros_monitor.ros_monitor", ros_monitor)

    assert main(["monitor", "--ros2", "robot.yaml"]) == 0
    assert main(["monitor", "--ros2", "robot.yaml", "--once", "--format", "json"]) == 0
    assert given == [("robot.yaml", "text", False), ("robot.yaml", "json", True)]
    with pytest.raises(SystemExit) as misused:
        main(["monitor", "http://robot:8000", "--ros2", "robot.yaml"])
    assert misused.value.code == 64
    assert "not allowed with argument" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (NoAnswerError("no service answers"), 2, "pilothouse: no service answers\n"),
        (ServiceProblemError({"detail": "a token is needed"}), 1, "rejected: a token is needed\n"),
    ],
)
def test_monitor_says_why_there_is_nothing_to_see(
    monkeypatch: pytest.MonkeyPatch, capsys: Output, error: Exception, code: int, words: str
) -> None:
    def fail(*_: object, once: bool) -> int:
        raise error

    monkeypatch.setattr("api.cli.monitor.monitor.monitor", fail)

    assert main(["monitor"]) == code
    assert capsys.readouterr() == ("", words)
