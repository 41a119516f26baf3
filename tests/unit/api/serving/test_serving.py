import os
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from api.access_token import FILE_VARIABLE, TOKEN_VARIABLE
from api.http.access import Access
from api.serving.composition import ServeOptions, compose, read_files
from api.serving.misuse import MisuseError
from api.serving.serving import access_of, greet, greeting_json, serve
from tests.support.manual_clock import ManualClock
from tests.support.ros_graph import FakeGraph

URL = "http://127.0.0.1:8000"


TOKEN = "correct-horse-battery"


def greeting(options: ServeOptions, access: Access | None = None) -> str:
    composition = compose(options, ManualClock(), read_files(options))
    return "\n".join(greet(composition, options, URL, access or Access.open()))


def test_the_greeting_says_what_is_served_where_and_what_is_not_real() -> None:
    told = greeting(ServeOptions())

    assert "the built-in example: 1 system, 2 nodes" in told
    assert f"page  {URL}/" in told
    assert f"curl {URL}/systems/actuation" in told
    assert "Simulated: nodes, signals, vehicle." in told


@pytest.mark.parametrize(("variable", "domain"), [("", "0"), ("42", "42")])
def test_the_greeting_of_a_real_robot_says_so(
    variable: str, domain: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = SimpleNamespace(RosLink=lambda: FakeGraph(ManualClock()))
    monkeypatch.setitem(sys.modules, "service.ros.graph.link", link)
    monkeypatch.setenv("ROS_DOMAIN_ID", variable)

    told = greeting(ServeOptions(backend="ros2", mock_signals=True))

    assert f"ROS 2: domain {domain}. Nodes are real" in told
    assert "Simulated: signals.\n" in told
    assert "Nothing here moves" not in told


def test_the_greeting_says_which_programs_end_with_the_service(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    link = SimpleNamespace(RosLink=lambda: FakeGraph(ManualClock()))
    monkeypatch.setitem(sys.modules, "service.ros.graph.link", link)
    file = tmp_path / "robot.yaml"
    file.write_text("nodes: {drive_base: {process: {command: [base]}}}\n")

    told = greeting(ServeOptions(backend="ros2", robot=file))

    assert "programs that it runs end with it, and other nodes stay as they are." in told


def test_without_ros_2_the_service_ends_with_what_to_do_about_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "service.ros.graph.link", None)

    assert serve(ServeOptions(backend="ros2", port=0)) == 2

    assert "setup.bash" in capsys.readouterr().err


def test_the_greeting_says_where_clients_of_rosbridge_connect() -> None:
    address = URL.replace("http://", "ws://")

    assert f"  ros   {address}/rosbridge " in greeting(ServeOptions())


def test_the_greeting_of_a_service_with_a_token_shows_how_to_send_it_and_not_the_token() -> None:
    told = greeting(ServeOptions(), Access.with_token(TOKEN))

    assert f'curl -H "Authorization: Bearer $PILOTHOUSE_TOKEN" {URL}/systems/actuation' in told
    assert f'Bearer $PILOTHOUSE_TOKEN" -X POST {URL}/systems/actuation/mode' in told
    assert "token needed" in told
    assert TOKEN not in told
    assert "token" not in greeting(ServeOptions()).lower()


def test_a_program_that_starts_the_service_is_told_where_it_listens() -> None:
    options = ServeOptions()
    composition = compose(options, ManualClock(), read_files(options))

    told = greeting_json(composition, options, URL, Access.with_token(TOKEN))

    assert told["url"] == URL
    assert told["token_needed"] is True
    assert told["model"] is None
    assert told["simulated"] == ["nodes", "signals", "vehicle"]
    assert TOKEN not in str(told)


# --- who is let in ------------------------------------------------------------------------------


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_an_address_that_others_reach_is_refused_until_it_is_said_who_may(
    host: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert serve(ServeOptions(host=host, port=0)) == 2

    told = capsys.readouterr().err
    for way in (TOKEN_VARIABLE, FILE_VARIABLE, "--anonymous"):
        assert way in told


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_a_token_is_asked_for_wherever_the_service_listens(host: str) -> None:
    access = access_of(ServeOptions(host=host), TOKEN)

    assert access.required
    assert access.accepts(TOKEN)


def test_this_machine_alone_needs_no_token() -> None:
    assert not access_of(ServeOptions(), None).required


def test_everybody_is_let_in_where_that_is_said() -> None:
    assert not access_of(ServeOptions(host="0.0.0.0", anonymous=True), None).required


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_a_token_and_everybody_contradict_each_other(host: str) -> None:
    with pytest.raises(MisuseError, match="leave out one of them") as caught:
        access_of(ServeOptions(host=host, anonymous=True), TOKEN)
    assert TOKEN not in str(caught.value)


def test_a_short_token_works_with_a_warning(caplog: pytest.LogCaptureFixture) -> None:
    assert access_of(ServeOptions(), "short").accepts("short")
    assert "less than 16 characters" in caplog.text
    caplog.clear()
    access_of(ServeOptions(), "x" * 16)
    assert caplog.text == ""


@pytest.mark.parametrize(
    ("environ", "why"),
    [
        ({TOKEN_VARIABLE: ""}, "it is empty"),
        ({TOKEN_VARIABLE: "two words"}, "a space"),
        ({FILE_VARIABLE: "/nowhere"}, "cannot read /nowhere"),
        ({TOKEN_VARIABLE: TOKEN, FILE_VARIABLE: "/nowhere"}, "both set"),
    ],
)
def test_a_token_that_cannot_be_used_ends_the_service_before_it_begins(
    environ: dict[str, str],
    why: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name, value in environ.items():
        monkeypatch.setenv(name, value)

    assert serve(ServeOptions(port=0)) == 2

    told = capsys.readouterr().err
    assert why in told
    assert TOKEN not in told
    assert TOKEN_VARIABLE not in os.environ
