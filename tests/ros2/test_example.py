"""What the pages about ROS 2 show is done, with real nodes, and compared with what comes."""

import json
import os
import re
import shlex
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from tests.ros2.support.terminal import Terminal
from tests.support.documents import Block, read_blocks
from tests.support.process import COMMAND, service
from tests.support.shared import PROJECT
from tests.support.shown_output import disagreement, last_json, missing_lines

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.timeout(240),
    pytest.mark.skipif(shutil.which("curl") is None, reason="there is no curl"),
]

PAGES = [
    PROJECT / "docs" / "ros2.md",
    PROJECT / "docs" / "how-to" / "start-a-robots-processes.md",
]
HERE = "needs ROS 2"
"""The mark of the commands that are run here and by no other test."""
DOMAIN = "ROS_DOMAIN_ID"
USUAL_ADDRESS = "localhost:8000"
REFUSED = 22
"""What curl ends with when the answer is an error, if it is told to."""
CURL_SETTINGS = 'silent\nshow-error\nfail-with-body\nmax-time = 60\nwrite-out = "\\n"\n'
SOON_S = 20.0
"""How long a page may mean with `<!-- comes soon -->`."""


class Reader:
    """Somebody with two terminals: one in which Pilothouse runs, and one for all else.

    Args:
        home: A folder, which becomes like the checkout.
        owner: Ends what was started.
    """

    def __init__(self, home: Path, owner: ExitStack) -> None:
        for path in PROJECT.iterdir():
            if not path.name.startswith("."):
                (home / path.name).symlink_to(path)
        (home / ".curlrc").write_text(CURL_SETTINGS)
        self._home = home
        self._address = USUAL_ADDRESS
        self._terminal = owner.enter_context(closing(Terminal(home, {"CURL_HOME": str(home)})))
        self._pilothouse = owner.enter_context(ExitStack())

    def do(self, block: Block, shown: Block | None) -> None:
        """Do what a block says; `shown` is what the page shows of what is printed."""
        if "file" in block.marks:
            (self._home / block.marks["file"]).write_text(block.text + "\n", encoding="utf-8")
        elif block.text.startswith("pilothouse serve "):
            self._serve(*shlex.split(block.text)[2:])
        elif "comes soon" in block.marks:
            self._repeat(block, shown)
        else:
            code, printed = self._enter(block)
            assert code == (REFUSED if "refused" in block.marks else 0), f"{block}\n{printed}"
            differs = _difference(shown, printed)
            assert differs is None, f"{shown}: {differs}\n{printed}"

    def _serve(self, *arguments: str) -> None:
        self._pilothouse.close()
        # What the service starts finds the Python of the tests, as what the reader starts does.
        path = f"PATH={Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        command = ("env", "-C", str(self._home), path, *COMMAND)
        process = self._pilothouse.enter_context(service(*arguments, command=command))
        self._address = process.url.removeprefix("http://")

    def _enter(self, block: Block) -> tuple[int, str]:
        commands = block.text.replace(USUAL_ADDRESS, self._address)
        # Pilothouse is started with the domain of the tests, in which nobody else is.
        domain = f"{DOMAIN}={os.environ[DOMAIN]}"
        return self._terminal.enter(re.sub(rf"{DOMAIN}=\d+", domain, commands))

    def _repeat(self, block: Block, shown: Block | None) -> None:
        """Ask until what is shown comes."""
        assert shown is not None, f"{block}: nothing is shown that could come"
        end = time.monotonic() + SOON_S
        while (differs := _difference(shown, printed := self._enter(block)[1])) is not None:
            assert time.monotonic() < end, f"{shown}: {differs}\n{printed}"
            time.sleep(0.1)


def _difference(shown: Block | None, printed: str) -> str | None:
    """Return in what the printed text differs from what a page shows; None: in nothing."""
    if shown is None:
        return None
    if shown.language == "json":
        return disagreement(json.loads(shown.text), last_json(printed), vary=False)
    return next(iter(missing_lines(shown.text, printed, vary=False)), None)


def blocks_to_do(page: Path) -> Iterator[tuple[Block, Block | None]]:
    """Yield what a page says is to be done with ROS 2, each with what it shows of it."""
    blocks = read_blocks(page)
    for number, block in enumerate(blocks):
        if block.marks.get("not run") == HERE:
            following = blocks[number + 1 : number + 2]
            yield block, following[0] if following and following[0].is_output else None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_can_be_followed_to_its_end(page: Path, tmp_path: Path) -> None:
    with ExitStack() as owner:
        reader = Reader(tmp_path, owner)
        for block, shown in blocks_to_do(page):
            reader.do(block, shown)
