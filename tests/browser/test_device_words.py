"""What the page says of the computers of a robot, in the only engine that runs it."""

from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

from tests.support.device_cases import CASES, PLACES
from tests.support.monitor import AT, device, frame, named, part, system, this_device

pytestmark = pytest.mark.browser

WORDS = 'const words = await import("/web/js/base/device_words.js");'


def run(page: Page, script: str, given: object = None) -> Any:  # noqa: ANN401 - whatever it returns
    return page.evaluate(f"async (given) => {{ {WORDS} {script} }}", given)


def test_page_and_terminal_say_the_same_of_devices(page: Page) -> None:
    script = """return given.map((devices) => [
        words.amiss(devices).map((device) => words.chipWords(device).text),
        words.deviceProblems(devices),
        words.notStoppedWords(devices),
    ]);"""
    said = run(page, script, [dict(case.devices) for case in CASES])
    for case, told in zip(CASES, said, strict=True):
        assert told == [[*case.amiss], [*case.problems], case.not_stopped], case.name


def test_page_and_terminal_say_the_same_of_where_a_stop_is_engaged(page: Page) -> None:
    said = run(page, "return given.map(words.stopPlaces);", [stop for stop, _ in PLACES])
    assert said == [words for _, words in PLACES]


def test_a_device_that_is_away_stands_for_its_parts_in_the_sentence(page: Page) -> None:
    parts = named(
        "name",
        system("robot", "drive_base", "lidar", converged=False),
        part("drive_base", reachable=False, device="arm"),
        part("lidar", reachable=False, device=None),
    )
    message = frame(parts=parts, devices={"arm": device("arm", "lost")})
    script = """
        const { emptyState, fold } = await import("/web/js/base/store.js");
        const { partProblems, partCounts } = await import("/web/js/base/part_problems.js");
        const { parts, devices } = fold(emptyState(), given);
        return [partProblems(parts, devices), partCounts(parts, devices).unreachable];
    """
    assert run(page, script, message) == [["device arm is lost", "lidar is unreachable"], 2]


@pytest.mark.parametrize(
    ("offline", "words"),
    [
        ({"target": {}, "reactions": False}, "When cut off, it stays as it is."),
        (
            {"target": {"drive_base": "inactive"}, "reactions": False},
            "When cut off for 2 s, drive_base goes to inactive.",
        ),
        (
            {
                "target": {"lidar": "active.__DEFAULT__", "drive_base": "inactive"},
                "reactions": True,
            },
            "When cut off for 2 s, drive_base goes to inactive, lidar goes to active.default,"
            " its reactions act.",
        ),
    ],
)
def test_the_inspector_says_what_a_device_does_when_it_is_cut_off(
    page: Page, offline: dict[str, Any], words: str
) -> None:
    given = {"after_s": 2.0, **offline}
    assert run(page, 'return words.offlineWords(given, "drive_base");', given) == words


def test_values_are_as_old_as_the_last_sign_of_life(page: Page) -> None:
    heard = [
        run(page, "return words.heardLast(given);", device("arm", state, heard_at=at))
        for state, at in (("connected", AT), ("late", AT), ("never_seen", None), ("lost", AT))
    ]
    assert heard[:3] == [None, None, None]
    assert heard[3] == run(page, "return Date.parse(given);", AT)


def test_the_page_of_a_device_says_whose_word_counts(page: Page) -> None:
    said = run(
        page,
        "return given.map(words.ownWords);",
        [this_device("arm", lead) for lead in ("nobody", "supervisor", "cut_off", "device")],
    )
    assert said == [
        "arm: no supervisor yet",
        "arm: the supervisor's word counts",
        "arm: cut off",
        "arm: acts alone",
    ]
