"""What the page makes of the words of the interface, where it reads them."""

import json

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Page

pytestmark = pytest.mark.browser


def test_in_texts_the_default_mode_is_called_default_and_requests_keep_its_name(
    desktop: Page,
) -> None:
    sent = {
        "mode": "__DEFAULT__",
        "modes": {"__DEFAULT__": 1},
        "words": "arm is active.__DEFAULT__, __DEFAULT__ requested",
        "label": "active.__DEFAULT__",
        "part": "my__DEFAULT__part",
    }
    read = desktop.evaluate(
        """async (text) => {
            const { parsePlain } = await import("/web/js/base/plain_json.js");
            return parsePlain(text);
        }""",
        json.dumps(sent),
    )
    words = "arm is active.default, default requested"
    assert read == {**sent, "words": words, "label": "active.default"}
