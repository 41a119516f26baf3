"""Trees of reasons and lists of steps, whatever they hold: each is shown once and in its place."""

import random
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

pytestmark = pytest.mark.browser

Tree = dict[str, Any]
RUNS = 300
NAMES = ("arm", "<b>arm</b>", "left/arm", "ärm & Co.", 'a "b"', "x" * 200)

SHOW_TREES = """async (every) => {
    const { nearestWords, reasonTree } = await import("/web/js/base/reasons.js");
    const read = (list) => [...list.children].map((item) => ({
        message: item.firstElementChild.textContent,
        root_cause: item.querySelector(":scope > .root") !== null,
        causes: item.querySelector(":scope > ul") ? read(item.querySelector(":scope > ul")) : [],
    }));
    return every.map((blockers) => [read(reasonTree(blockers)), blockers.map(nearestWords)]);
}"""

SHOW_STEPS = """async (every) => {
    const { stepLists } = await import("/web/js/base/step_list.js");
    return every.map((steps) => {
        const nodes = stepLists(steps, 0);
        const titles = nodes.filter(({ tagName }) => tagName === "H4");
        const lists = nodes.filter(({ tagName }) => tagName === "OL");
        const nameOf = (item) => item.children[1].textContent;
        return [titles.map((title) => title.textContent),
                lists.map((list) => [...list.children].map(nameOf))];
    });
}"""


def a_blocker(chance: random.Random, depth: int) -> Tree:
    count = chance.choice((0, 0, 1, 1, 2, 3)) if depth else 0
    path = [chance.choice(NAMES) for _ in range(chance.randrange(4))]
    return {
        "code": "CONDITION",
        "message": f"{chance.choice(NAMES)} is {chance.random()}",
        "path": path,
        "since_at": chance.choice((None, "2026-05-04T12:00:00.000Z")),
        "root_cause": count == 0,
        "refuses": chance.random() < 0.8,
        "causes": [a_blocker(chance, depth - 1) for _ in range(count)],
        "condition": chance.choice((None, "battery_level >= 0.3")),
    }


def as_read(blocker: Tree) -> Tree:
    causes = [as_read(cause) for cause in blocker["causes"]]
    return {"message": blocker["message"], "root_cause": blocker["root_cause"], "causes": causes}


def nearest(blocker: Tree) -> str:
    goes_on = blocker["condition"] and len(blocker["causes"]) == 1
    return nearest(blocker["causes"][0]) if goes_on else str(blocker["message"])


def test_every_reason_is_shown_once_below_what_follows_from_it(page: Page) -> None:
    chance = random.Random(14)
    trees = [[a_blocker(chance, 4) for _ in range(chance.randrange(4))] for _ in range(RUNS)]
    shown = page.evaluate(SHOW_TREES, trees)
    assert [tree for tree, _ in shown] == [[as_read(one) for one in tree] for tree in trees]
    assert [words for _, words in shown] == [[nearest(one) for one in tree] for tree in trees]


def a_step(chance: random.Random, number: int) -> Tree:
    started, ended = chance.choice(((False, False), (True, False), (True, True)))
    return {
        "node": f"{chance.choice(NAMES)} {number}",
        "action": "activate",
        "status": chance.choice(("pending", "running", "succeeded", "failed", "canceled")),
        "started_at": "2026-05-04T12:00:00.000Z" if started else None,
        "ended_at": "2026-05-04T12:00:01.000Z" if ended else None,
        "error": chance.choice((None, "no answer")),
        "stage": chance.choice((0, 1, 2, 5)),
        "after": [chance.choice(NAMES)] if chance.random() < 0.5 else [],
        "expected_s": chance.choice((None, 0.3)),
        "rollback": chance.random() < 0.2,
    }


def expected_lists(steps: list[Tree]) -> list[Any]:
    groups: dict[str, list[str]] = {}
    for step in sorted(
        steps, key=lambda one: (one["rollback"], one["stage"] * (1 - one["rollback"]))
    ):
        title = "Going back" if step["rollback"] else f"Stage {step['stage'] + 1}"
        groups.setdefault(title, []).append(f"{step['node']}: activate")
    return [list(groups) if len(groups) > 1 else [], list(groups.values())]


def test_every_step_is_shown_once_in_its_stage_and_the_way_back_last(page: Page) -> None:
    chance = random.Random(14)
    plans = [[a_step(chance, n) for n in range(chance.randrange(9))] for _ in range(RUNS)]
    assert page.evaluate(SHOW_STEPS, plans) == [expected_lists(steps) for steps in plans]


def test_an_error_with_numbers_and_without_a_signal_tells_them_plainly(desktop: Page) -> None:
    told = desktop.evaluate(
        """async () => {
            const { measured } = await import("/web/js/inspector/error_words.js");
            const error = { value: 0.9, threshold: 0.2, message: "max_speed drifted" };
            return measured(error, undefined);
        }"""
    )
    assert told == "0.9, limit 0.2"
