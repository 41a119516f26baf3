import errno
import re
import subprocess
import sys
from pathlib import Path

import pytest

from api import distribution
from api.cli import command_line
from api.cli.command_line import main
from api.cli.parser import GROUPS, places
from api.client.outcomes import Outcome

Output = pytest.CaptureFixture[str]

COMMANDS = tuple(places())


def exit_code(*arguments: str) -> int:
    """Return the code of a command that argparse ends."""
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_without_a_command_it_says_what_there_is(capsys: Output) -> None:
    assert main([]) == 64

    told = capsys.readouterr().out
    assert [line for line in told.splitlines() if len(line) > 80] == []
    for group, commands in GROUPS.items():
        listed = told.partition(f"{group}:\n")[2].partition("\n\n")[0]
        assert [line.split()[0] for line in listed.splitlines()] == list(commands)
    for code in ("0", "1", "2", "64", "130"):
        assert re.search(rf"^  {code} +\w", told, re.MULTILINE)


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
        (["serve", "--port", "65536"], "invalid port 65536"),
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
        (["shelve", "ESTOP"], "say why"),
        (["shelve", "ESTOP", "--reason", "x", "--for", "5d"], "invalid time '5d'"),
        (["release", "operator", "--reason", "x"], "for the emergency stop"),
        (["events", "--limit", "0"], "expected 1 to 1000"),
        (["completion", "tcsh"], "invalid choice"),
        (["monitor", "--format", "xml"], "invalid choice"),
        (["fly"], "invalid choice"),
    ],
)
def test_a_misspelt_command_line_has_an_exit_code_of_its_own(
    arguments: list[str], words: str, capsys: Output
) -> None:
    assert exit_code(*arguments) == 64
    assert words in capsys.readouterr().err


HEAVY = {"asyncio", "domain", "fastapi", "httpx", "numpy", "pydantic", "rich", "websockets"}


def loaded_after(statement: str) -> set[str]:
    """Return what a process has imported after a statement, which may not print."""
    code = f"import sys; from api.cli.command_line import main; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_help_is_quick_since_nothing_is_imported_that_it_does_not_need() -> None:
    loaded = loaded_after("from api.cli.parser import make_parser, places; make_parser(places())")

    assert "api.cli.commands.monitor" in loaded
    assert HEAVY.isdisjoint(loaded)


def test_a_stop_loads_no_other_command_and_no_library() -> None:
    loaded = loaded_after("main(['stop', '--url', 'http://127.0.0.1:1', '--retry', '0'])")

    assert "api.client.bare_request" in loaded
    assert HEAVY.isdisjoint(loaded)
    assert {name for name in loaded if name.startswith("api.cli.commands.")} == {
        "api.cli.commands.command",
        "api.cli.commands.stop",
    }


def test_ctrl_c_ends_without_a_trace(monkeypatch: pytest.MonkeyPatch, capsys: Output) -> None:
    def change(*_: object) -> Outcome:
        raise KeyboardInterrupt

    monkeypatch.setattr("api.cli.commands.change.change", change)

    assert main(["mode", "actuation", "PERFORMANCE"]) == 130
    assert capsys.readouterr() == ("", "")


def test_a_foreign_package_is_told_before_anything_is_done(
    monkeypatch: pytest.MonkeyPatch, capsys: Output
) -> None:
    def find_foreign() -> None:
        raise distribution.ForeignPackageError("domain", "it lies elsewhere")

    monkeypatch.setattr(distribution, "check_packages", find_foreign)

    assert main(["check", "robot.yaml"]) == 1
    told = capsys.readouterr().err
    assert "'domain'" in told
    assert "environment of its own" in told


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (("chek", "x"), "check"),
        (("serve", "--prot", "1"), "--port"),
        (("monitor", "--onec"), "--once"),
        (("stpo",), "stop"),
        (("hodl", "lunch"), "hold"),
        (("state", "drive_base", "activat"), "activate"),
        (("serve", "--log-level", "debg"), "debug"),
    ],
)
def test_what_is_mistyped_is_answered_with_what_was_meant(
    typed: tuple[str, ...], meant: str, capsys: Output
) -> None:
    assert exit_code(*typed) == 64
    assert capsys.readouterr().err.endswith(f"; did you mean {meant}?\n")


@pytest.mark.parametrize(
    "command",
    [
        ("serve", "no.yaml", "--port", "0"),
        ("serve", "--robot", "no.yaml", "--port", "0"),
        ("check", "no.yaml"),
        ("simulate", "no.yaml"),
        ("task", "no.csv"),
    ],
)
def test_a_file_that_is_not_there_has_one_exit_code_everywhere(
    command: tuple[str, ...], capsys: Output, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    assert main(command) == 2
    assert "cannot be read: No such file" in capsys.readouterr().err


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EIO])
def test_an_output_that_takes_nothing_is_told_in_one_line(
    number: int, capsys: Output, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: object) -> int:
        raise OSError(number, "it is full")

    monkeypatch.setattr(command_line, "_run", fail)
    monkeypatch.setattr(command_line, "give_up_output", lambda: None)

    assert main(["check", "x"]) == 1
    assert capsys.readouterr().err == "pilothouse: cannot write to standard output: it is full\n"
