"""The page says of the state of the robot what the terminal says, case by case."""

from datetime import datetime
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

from api.cli.monitor import sentence, words
from tests.support.monitor import AT, frame, robot, view
from tests.support.sentence_cases import CASES, STORAGE, Case, combinations

pytestmark = pytest.mark.browser

SAY = """async (frames) => {
    const { emptyState, fold } = await import("/web/js/base/store.js");
    const said = await import("/web/js/base/state_sentence.js");
    return frames.map((frame) => {
        const state = fold(emptyState(), frame);
        const { word, level, text, more } = said.robotSentence(state);
        return [word, level, text, more, said.standstillWords(state)];
    });
}"""


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_what_the_page_says_of_a_state_is_true(page: Page, case: Case) -> None:
    [[word, level, text, more, _]] = page.evaluate(SAY, [frame(**case.members)])
    ended = words.time_of_day(datetime.fromisoformat(AT).timestamp())
    assert (word, level) == (case.word, case.level)
    assert text == case.text.format(ended=ended)
    assert tuple(more) == case.more


def test_page_and_terminal_say_the_same_in_every_combination(page: Page) -> None:
    frames = [frame(**members) for members in combinations()]
    said: list[Any] = page.evaluate(SAY, frames)
    for message, on_page in zip(frames, said, strict=True):
        known = robot(message)
        told = sentence.state_sentence(view(known))
        assert told is not None
        stands = sentence.standstill_words(known)
        assert on_page == [told.word, told.level, told.text, [*told.more], stands], message


def test_the_page_says_of_storage_what_the_terminal_says(page: Page) -> None:
    script = """async (cases) => {
        const { emptyState, fold } = await import("/web/js/base/store.js");
        const { storageSentence } = await import("/web/js/base/state_sentence.js");
        return cases.map(([frame, level]) => {
            const said = storageSentence(fold(emptyState(), frame), { level });
            return said && [said.word, said.text];
        });
    }"""
    frames = [(frame(system_state=state), contact) for state, contact, _ in STORAGE]
    said = page.evaluate(script, frames)
    assert said == [None if told is None else [*told] for _, _, told in STORAGE]


def test_without_contact_the_page_tells_of_when_it_is_and_what_the_robot_was_in(
    page: Page,
) -> None:
    script = """async (frame) => {
        const { emptyState, fold } = await import("/web/js/base/store.js");
        const { stateSentence } = await import("/web/js/base/state_sentence.js");
        const state = fold(emptyState(), frame);
        return stateSentence(state, { level: "lost", silenceMs: 14000 });
    }"""
    said = page.evaluate(script, frame(**CASES[1].members))
    assert said["level"] == "lost"
    assert said["word"] == "No contact for 14 s"
    assert said["text"].startswith("values shown are from ")
    assert said["more"] == ["it was RUNNING: task t1 42 %, waypoint 41 of 66"]
