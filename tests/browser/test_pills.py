"""What the pills of a part say, in the only engine that runs them."""

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

from api.cli.monitor.words import Json
from tests.support.monitor import part

pytestmark = pytest.mark.browser

WHY = {"message": "manipulator is inactive"}
BY_RULE = {
    "state": "active",
    "mode": "SLOW",
    "because": "rule",
    "rule": "slow_down",
    "blockers": [WHY],
}
REQUESTED = {**BY_RULE, "because": "requested", "rule": None, "blockers": []}


def shown(page: Page, given: Json) -> list[str]:
    """Return text and title of who set the target of a part, as its pills show it."""
    found = page.evaluate(
        """(part) => {
            const pills = document.createElement("ph-pills");
            pills.show(part);
            const setter = pills.querySelector(".setter");
            return setter ? [setter.textContent.trim(), setter.title] : [];
        }""",
        given,
    )
    assert isinstance(found, list)
    return found


def test_a_target_that_a_rule_set_has_its_name_beside_it_and_why(page: Page) -> None:
    slow = part("drive_base", mode="SLOW", effective_target=BY_RULE)

    assert shown(page, slow) == ["rule slow_down", "manipulator is inactive"]
    assert shown(page, {**slow, "converged": False, "actual": part("x")["actual"]})[0] == (
        "rule slow_down"
    )


def test_a_target_that_was_requested_needs_no_word_more(page: Page) -> None:
    assert shown(page, part("drive_base", mode="SLOW", effective_target=REQUESTED)) == []
    assert shown(page, part("drive_base", mode="SLOW")) == []
