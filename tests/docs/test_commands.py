"""Every command in README and docs is run, in order, against a real service."""

import json
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import httpx
import pytest

from tests.support.documents import Block, read_blocks
from tests.support.process import COMMAND, ServiceProcess, service
from tests.support.shared import PROJECT
from tests.support.shown_output import disagreement, last_json, missing_lines

PAGES = [
    PROJECT / "README.md",
    *sorted((PROJECT / "docs").rglob("*.md")),
    PROJECT / "examples" / "mobile_manipulator" / "README.md",
    PROJECT / "examples" / "mobile_robot" / "README.md",
]
NOT_RUN = {
    # What is meant by this is run by tests/ros2/test_example.py.
    "needs ROS 2",
    "needs a container engine",
    "needs another machine",
    "needs root",
    "needs a terminal",
    "takes minutes",
    "never ends",
}
ADDRESS = re.compile(r"(?:localhost|127\.0\.0\.1):8000")
STARTS = re.compile(r"make |(?:\.venv/bin/)?pilothouse serve\b")
NOT_FOR_A_TEST = re.compile(r"\b(?:apt|apt-get|docker|pip|podman|rm|ssh|sudo|systemctl)\b")
ATTEMPTS = 3
REFUSED = 22
"""What curl ends with when the answer is an error, if it is told to."""
NO_SUCH_OPTION = 9
"""What node ends with if it is too old to have a WebSocket."""
CURL_SETTINGS = 'silent\nshow-error\nfail-with-body\nmax-time = 60\nwrite-out = "\\n"\n'
# Copied for a page that writes below the source; otherwise these are links as well.
SOURCE = ("api", "domain", "pyproject.toml", "service", "tests", "web")


class Reader:
    """Somebody who does what a page says, with a folder like the checkout, and a service."""

    def __init__(self, home: Path, blocks: list[Block], owner: ExitStack) -> None:
        """Make the folder.

        Args:
            home: Where it is; empty.
            blocks: Of the page.
            owner: Ends the service.
        """
        written = {block.marks.get("file", "").partition("/")[0] for block in blocks}
        self._home = home
        self._owner = owner
        self._service: ServiceProcess | None = None
        for path in PROJECT.iterdir():
            if path.name in SOURCE and not written.isdisjoint(SOURCE):
                copy = shutil.copytree if path.is_dir() else shutil.copy
                copy(path, home / path.name)
            elif not path.name.startswith(".") or path.name == ".venv":
                (home / path.name).symlink_to(path)
        (home / ".curlrc").write_text(CURL_SETTINGS)

    def do(self, block: Block) -> str:
        """Run the commands of a block; return what they print."""
        outside = NOT_FOR_A_TEST.search(block.text)
        why = f"{block}: {outside and outside[0]}: mark it `<!-- not run: REASON -->`"
        assert outside is None, why
        script = "\n".join(self._lines(block))
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", self.localized(script)],
            cwd=self._home,
            env=self._environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        wanted = REFUSED if "refused" in block.marks else _exit_code(block)
        assert done.returncode == wanted, f"{block}\n{done.stdout}\n{done.stderr}"
        return done.stdout

    def play(self, block: Block) -> str:
        """Run a script for a browser; return what it prints, or nothing where no node can."""
        node = shutil.which("node")
        if node is None:
            return ""
        done = subprocess.run(
            [node, "--experimental-websocket", self._home / block.marks["file"]],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode in (0, NO_SUCH_OPTION), f"{block}\n{done.stderr}"
        return done.stdout

    def write(self, block: Block) -> None:
        """Write a block that is a file."""
        path = self._home / block.marks["file"]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(self.localized(block.text) + "\n", encoding="utf-8")

    def localized(self, text: str) -> str:
        """Return text with the address of the service of this page in place of the usual one."""
        if not ADDRESS.search(text):
            return text
        return ADDRESS.sub(self._url().removeprefix("http://"), text)

    def has_lost_its_vehicle(self) -> bool:
        """Tell whether the service put its vehicle on hold, since no pose came in time."""
        if self._service is None or not self._service.runs:
            return False
        events = httpx.get(f"{self._service.url}/events?kind=hold.set&limit=1000").json()["items"]
        return any(event["data"]["owner"] == "vehicle" for event in events)

    def _lines(self, block: Block) -> Iterator[str]:
        """Yield the lines to run; what starts a service is done at once, in place of the last."""
        for line in block.text.splitlines():
            # A line of its own only: others may be a part of a longer text in quotes.
            words = shlex.split(line, comments=True) if STARTS.match(line) else []
            if words[:1] == ["make"]:
                assert is_target(words[1]), f"{block}: make {words[1]}"
                if words[1] == "run":
                    self._serve()
            elif words:
                self._serve(*words[2:])
            else:
                yield line

    def _serve(self, *arguments: str) -> None:
        there = 'cd "$0" && PYTHONPATH="$0" exec "$@"'
        command = ("sh", "-c", there, str(self._home), *COMMAND)
        self._owner.close()
        self._service = self._owner.enter_context(service(*arguments, command=command))

    def _url(self) -> str:
        if self._service is None:
            self._serve()
        assert self._service is not None
        return str(self._service.url)

    def _environment(self) -> dict[str, str]:
        programs = Path(COMMAND[0]).parent
        return {
            **os.environ,
            "PATH": f"{programs}:{os.environ['PATH']}",
            "PYTHONPATH": str(self._home),
            "CURL_HOME": str(self._home),
            "NO_COLOR": "1",
            # What a tracker's tests do not need, and what takes longest to load.
            "PYTEST_ADDOPTS": "-p no:cacheprovider -p no:schemathesis -p no:playwright",
            **({"PILOTHOUSE_URL": self._service.url} if self._service else {}),
        }


def _exit_code(block: Block) -> int:
    codes = [mark.removeprefix("ends with ") for mark in block.marks if mark.startswith("ends ")]
    return int(codes[0]) if codes else 0


def is_target(name: str) -> bool:
    """Tell whether the Makefile has a target."""
    text = (PROJECT / "Makefile").read_text(encoding="utf-8")
    return re.search(rf"^{re.escape(name)}:", text, re.MULTILINE) is not None


def assert_as_shown(block: Block, printed: str, reader: Reader) -> None:
    """Compare what a page shows with what was printed."""
    vary = "numbers vary" in block.marks
    shown = reader.localized(block.text)
    if block.language == "json":
        where = disagreement(json.loads(shown), last_json(printed), vary=vary)
        assert where is None, f"{block}: {where}\n{printed}"
    else:
        missing = missing_lines(shown, printed, vary=vary)
        assert not missing, f"{block}: {missing[0]!r} is not in\n{printed}"


# --- the tests -----------------------------------------------------------------------------------


def has_something_to_do(page: Path) -> bool:
    """Tell whether a page holds commands that are run."""
    return any(block.is_command and "not run" not in block.marks for block in read_blocks(page))


# The longest first, so that the others go on beside it.
FOLLOWED = sorted(filter(has_something_to_do, PAGES), key=lambda page: page.name != "tutorial.md")


def follow(page: Path, homes: Iterator[Path]) -> None:
    """Do what a page says from its begin to its end.

    Pages show a robot whose pose is always fresh. A service that got no time from a busy machine
    has put its vehicle on hold for a moment: the page is then followed again, with a new service.

    Args:
        page: What to follow.
        homes: Empty folders, one for each attempt.
    """
    for home in homes:
        with ExitStack() as owner:
            blocks = read_blocks(page)
            reader = Reader(home, blocks, owner)
            try:
                follow_blocks(blocks, reader)
            except AssertionError:
                if not reader.has_lost_its_vehicle():
                    raise
            else:
                return
    pytest.fail(f"{page.name}: the machine is too busy for a vehicle")


def follow_blocks(blocks: list[Block], reader: Reader) -> None:
    """Let a reader do what blocks say, and compare what they show."""
    printed = ""
    for block in blocks:
        if "file" in block.marks:
            reader.write(block)
            printed = reader.play(block) if block.language == "js" else ""
        elif "not run" in block.marks:
            printed = ""
        elif block.is_command:
            printed = reader.do(block)
        elif block.is_output and printed:
            assert_as_shown(block, printed, reader)


@pytest.fixture(scope="module")
def followed(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Mapping[Path, Future[None]]]:
    """Follow the pages that are asked for, two at a time: much of it is waiting for a vehicle."""
    here = [item for item in request.session.items if item.path == request.path]
    asked = [getattr(item, "callspec", None) for item in here]
    pages = [found.params["page"] for found in asked if found and "page" in found.params]
    mine = [page for page in FOLLOWED if page in pages]
    with ThreadPoolExecutor(2) as pool:
        yield {
            page: pool.submit(
                follow, page, iter([tmp_path_factory.mktemp("page") for _ in range(ATTEMPTS)])
            )
            for page in mine
        }


# Pages that drive take their time, and on a busy machine more of it.
@pytest.mark.timeout(240)
@pytest.mark.skipif(shutil.which("curl") is None, reason="there is no curl")
@pytest.mark.parametrize("page", FOLLOWED, ids=lambda page: str(page.relative_to(PROJECT)))
def test_a_page_can_be_followed_to_its_end(
    page: Path, followed: Mapping[Path, Future[None]]
) -> None:
    followed[page].result()


def test_only_what_cannot_be_run_here_is_not_run() -> None:
    marked = [
        f"{block}: {block.marks['not run']}"
        for page in PAGES
        for block in read_blocks(page)
        if block.marks.get("not run", "never ends") not in NOT_RUN
    ]

    assert not marked, "\n".join(marked)


def test_a_page_that_shows_something_else_is_noticed() -> None:
    shown = {"state": "active", "at": "...", "steps": [{"node": "a"}, "..."], "count": 3}
    seen = {"state": "active", "at": 5, "steps": [{"node": "a", "x": 1}, {}], "count": 4, "y": 2}

    assert disagreement(shown, seen, vary=True) is None
    assert disagreement(shown, seen, vary=False) == "/count: 4"
    assert disagreement({"steps": [{"node": "b"}, "..."]}, seen, vary=True) == "/steps/0/node: 'a'"
    assert disagreement({"steps": [{}]}, seen, vary=True) == "/steps: 2 items"
    assert disagreement({"gone": None}, seen, vary=True) == "/gone: 'nothing'"
    assert missing_lines("a\n...\nc 1 ... s", "a\nb\nc 1 in 2 s\n", vary=False) == []
    assert missing_lines("c 1 s\na", "a\nc 12.5 s\n", vary=True) == ["a"]
