"""How a process ended, in words."""

import pytest

from domain.process_terms import ProcessExit


@pytest.mark.parametrize(
    ("end", "words", "is_failure"),
    [
        (ProcessExit(0), "exit code 0", False),
        (ProcessExit(3), "exit code 3", True),
        (ProcessExit(signal="SIGKILL"), "ended by SIGKILL", True),
        (ProcessExit(127, reason="the command was not found"), "the command was not found", True),
        (ProcessExit(reason="it could not be started"), "it could not be started", True),
    ],
)
def test_an_end_is_told_in_words(end: ProcessExit, words: str, is_failure: bool) -> None:
    assert (end.words, end.is_failure) == (words, is_failure)
