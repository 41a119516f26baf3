import subprocess

import pytest

from api.cli.command_line import main


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell_asks_the_command_itself(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["completion", shell]) == 0

    script = capsys.readouterr().out
    assert "_ARGCOMPLETE" in script
    assert "pilothouse" in script


def test_the_script_is_one_for_bash(capsys: pytest.CaptureFixture[str]) -> None:
    main(["completion", "bash"])

    script = capsys.readouterr().out
    assert subprocess.run(["bash", "-n"], input=script, text=True, check=False).returncode == 0
