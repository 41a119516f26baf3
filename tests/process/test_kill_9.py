"""A service that is killed under load has forgotten nothing that it answered for."""

from pathlib import Path

import pytest

from tests.support.kill_rounds import kill_rounds


@pytest.mark.timeout(180)
async def test_what_was_answered_is_there_after_each_of_ten_kills(tmp_path: Path) -> None:
    expected, _ = await kill_rounds(tmp_path / "robot", 10, seed=1)

    assert expected.answered > 100
    assert expected.tasks
    assert expected.events
