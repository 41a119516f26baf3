"""The page of a recording as a process of its own."""

import signal
from pathlib import Path

from tests.support.process import replay_page
from tests.support.stored_robot import held_on_its_way, store


def test_it_says_what_it_shows_and_where_and_ends_with_a_signal(tmp_path: Path) -> None:
    store(tmp_path / "gem_e2", held_on_its_way())

    with replay_page(tmp_path / "gem_e2") as process:
        assert process.greeting.splitlines() == [
            "REPLAY of gem_e2, from 2026-01-01 00:00:00 to 2026-01-01 00:00:04 UTC",
            f"  page  {process.url}/",
            "Nothing here reaches a robot. Ctrl-C ends it.",
        ]
        process.send_signal(signal.SIGINT)
        code, _, complaints = process.ended()

    assert (code, complaints) == (0, "")
