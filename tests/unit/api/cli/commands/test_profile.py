from pathlib import Path

import pytest

from api.cli.command_line import main
from api.cli.profile_run import ProfileOptions
from api.profiling.triggers import TRIGGERS


def test_profile_hands_on_what_it_was_told(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[ProfileOptions] = []

    def measure(options: ProfileOptions) -> int:
        given.append(options)
        return 1

    monkeypatch.setattr("api.cli.profile_run.measure", measure)
    few = ["--trigger", "ESTOP", "--trigger", "GPS_LOST", "--trigger", "ESTOP", "--runs", "3"]

    assert main(["profile"]) == 1
    assert main(["profile", "m", "--robot", "r", "--out", "o", "--plot", *few]) == 1

    assert given == [
        ProfileOptions(None, None, 10, tuple(TRIGGERS), None, "text", plot=False),
        ProfileOptions(
            Path("m"), Path("r"), 3, ("ESTOP", "GPS_LOST"), Path("o"), "text", plot=True
        ),
    ]


def test_profile_analyses_earlier_data(monkeypatch: pytest.MonkeyPatch) -> None:
    given: list[tuple[object, ...]] = []

    def analyse(*asked: object, plot: bool) -> int:
        given.append((*asked, plot))
        return 1

    monkeypatch.setattr("api.cli.profile_run.analyse", analyse)

    assert main(["profile", "--analyse", "a", "b", "--format", "json"]) == 1

    assert given == [([Path("a"), Path("b")], None, "json", False)]


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--runs", "0"], "invalid number of runs 0; expected at least 1"),
        (["--trigger", "ESTOPP"], "did you mean ESTOP?"),
        (["--runs", "many"], "invalid _runs value: 'many'"),
    ],
)
def test_profile_rejects_what_makes_no_sense(
    options: list[str], complaint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["profile", *options])

    assert ended.value.code == 64
    assert complaint in capsys.readouterr().err
