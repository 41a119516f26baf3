import json
import unicodedata

from hypothesis import given
from hypothesis import strategies as st

from api.cli.checked_file import CheckedFile, as_json, as_text
from api.cli.sarif import as_sarif
from domain.computers import ComputerName
from domain.devices.sub_model import LeftOut
from domain.findings import Finding
from service.files.model_file import check_model

ERROR = Finding("error", "BAD", "no mode FASTT; did you mean FAST?", "arm", (), 2, 4)
WARNING = Finding("warning", "ODD", "this is odd", None, (), 1, 1)


def test_a_finding_is_shown_with_its_line_a_caret_and_what_was_probably_meant() -> None:
    file = CheckedFile("robot.yaml", "a:\n  b: FASTT\n", (WARNING, ERROR))

    assert list(as_text([file])) == [
        "robot.yaml:1:1: warning[ODD]: this is odd",
        "    1 | a:",
        "      | ^",
        "robot.yaml:2:4: error[BAD]: no mode FASTT",
        "    2 |   b: FASTT",
        "      |    ^",
        "      = help: did you mean FAST?",
        "robot.yaml: invalid (1 error, 1 warning)",
    ]


def test_each_of_several_files_is_summed_up() -> None:
    files = [CheckedFile("model.yaml", "a", ()), CheckedFile("robot.yaml", "a", (WARNING,))]

    assert list(as_text(files))[-2:] == ["model.yaml: valid", "robot.yaml: valid (1 warning)"]


def test_nothing_of_a_file_steers_the_terminal() -> None:
    finding = Finding("error", "BAD", "\x1b[2J", None, (), 1, 1)
    file = CheckedFile("\x1b]0;x\x07", "\x1b[31m", (finding,))

    assert not any("\x1b" in line or "\x07" in line for line in as_text([file]))


def test_a_program_gets_all_findings_with_their_files() -> None:
    files = [CheckedFile("model.yaml", "a", (ERROR,)), CheckedFile("robot.yaml", "a", (WARNING,))]

    shown = json.loads(as_json(files))

    assert shown["valid"] is False
    assert [(f["code"], f["file"], f["line"]) for f in shown["findings"]] == [
        ("BAD", "model.yaml", 2),
        ("ODD", "robot.yaml", 1),
    ]


PIECES = st.sampled_from(
    ["arm:\n", "  ros__parameters:\n", "    type: node\n", "    mode_settings: {A: {", "requires: ",
     "[", "]", "{", "}", "\x1b[2J", "\u202e", "\t", "\x07", "日本", "e\u0301", "\r", "\x85", "*a",
     "&a ", "'", '"', "x" * 300, "\U000e0001", "\ufeff", "null", "estop > 3 and", "\n"]
)  # fmt: skip


@given(st.text() | st.lists(PIECES, max_size=30).map("".join))
def test_whatever_is_in_a_file_each_finding_is_one_line_with_its_line_and_a_caret(
    text: str,
) -> None:
    file = CheckedFile("robot.yaml", text, check_model(text))

    lines = list(as_text([file]))

    hidden = {c for line in lines for c in line if unicodedata.category(c) in ("Cc", "Cf", "Zl")}
    assert not hidden
    assert sum(line.startswith("robot.yaml:") for line in lines) == len(file.findings) + 1
    assert sum(line.endswith(" ^") for line in lines) >= len(file.findings)


@given(st.text() | st.lists(PIECES, max_size=30).map("".join))
def test_whatever_is_in_a_file_programs_get_json(text: str) -> None:
    file = CheckedFile("robot.yaml", text, check_model(text))

    (run,) = json.loads(as_sarif([file]))["runs"]
    assert len(run["results"]) == len(json.loads(as_json([file]))["findings"]) == len(file.findings)
    for result in run["results"]:
        assert run["tool"]["driver"]["rules"][result["ruleIndex"]]["id"] == result["ruleId"]


def test_what_devices_leave_to_the_supervisor_follows_the_verdicts() -> None:
    files = [CheckedFile("robot.yaml", "a", ())]
    left = {ComputerName("arm"): (LeftOut("guard of arm, estop == false", "estop is not its own"),)}

    assert list(as_text(files, left)) == [
        "robot.yaml: valid",
        "device arm leaves to the supervisor:",
        "  guard of arm, estop == false: estop is not its own",
    ]
    (shown,) = json.loads(as_json(files, left))["left_out"]
    assert shown["device"] == "arm"
    assert json.loads(as_json(files))["left_out"] == []
