"""Pieces of Python, JavaScript, YAML and JSON on the pages are what they say they are."""

import ast
import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from tests.support.documents import Block, read_blocks
from tests.support.shared import PROJECT

PAGES = [
    PROJECT / "README.md",
    *sorted((PROJECT / "docs").rglob("*.md")),
    PROJECT / "examples" / "mobile_manipulator" / "README.md",
    PROJECT / "examples" / "mobile_robot" / "README.md",
]
BLOCKS = [block for page in PAGES for block in read_blocks(page)]


def check_javascript(text: str) -> None:
    """Let node read a module, without running it; where there is no node, nothing is checked."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("there is no node")
    command = [node, "--input-type=module", "--check", "-"]
    done = subprocess.run(
        command, input=text, capture_output=True, text=True, timeout=20, check=False
    )
    assert done.returncode == 0, done.stderr


CHECKS: dict[str, Callable[[str], object]] = {
    "python": ast.parse,
    "js": check_javascript,
    "yaml": yaml.safe_load,
    "json": json.loads,
}


@pytest.mark.parametrize("block", [b for b in BLOCKS if b.language in CHECKS], ids=str)
def test_a_piece_of_a_page_can_be_read(block: Block) -> None:
    CHECKS[block.language](block.text)


def test_a_block_is_of_a_language_that_is_checked() -> None:
    known = {*CHECKS, "sh", "text", "", "csv", "ini", "nginx"}

    assert [str(block) for block in BLOCKS if block.language not in known] == []


def test_marks_belong_to_the_block_below_them(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "Words.\n\n<!-- refused -->\n```sh\ncurl x\n```\n\n"
        "<!-- numbers vary -->\n```json\n{}\n```\n"
        "\nMore.\n\n    curl a \\\n      b\n\n    curl c\n\n* item\n",
        encoding="utf-8",
    )
    command, output, indented = read_blocks(page)

    assert (command.is_command, command.marks, command.line) == (True, {"refused": ""}, 5)
    assert (output.is_output, output.marks) == (True, {"numbers vary": ""})
    assert indented.is_command
    assert indented.text == "curl a \\\n  b\n\ncurl c"
    assert not indented.follows
