import subprocess
import sys

import pytest

CHECK = "import os, sys; from api.cli.standard_files import open_missing; open_missing(); "


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&-", "<&- >&- 2>&-"])
def test_a_file_that_is_opened_later_never_takes_the_place_of_a_standard_one(closed: str) -> None:
    code = CHECK + (
        "sys.stdin.read(); print('x'); print('x', file=sys.stderr);"
        "sys.exit(os.open(os.devnull, os.O_RDONLY) <= 2)"
    )
    command = f'exec "{sys.executable}" -c "{code}" {closed}'

    assert subprocess.run(["bash", "-c", command], stdin=subprocess.DEVNULL).returncode == 0
