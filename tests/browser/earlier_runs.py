"""A log of three runs of the service, as `GET /events` would tell it to the page."""

import json
from typing import Any
from urllib.parse import parse_qs, urlsplit

from playwright.sync_api import Page, Route

LAST = 422
_BOOTS = {"one": range(1, 301), "two": range(321, 361), "three": range(361, LAST + 1)}
"""Events 301 to 320 were lost when the first run was killed."""
_LOST = 301
_GAP = {"type": "gap", "from": _LOST, "to": 320, "epoch": "one"}


def _event(epoch: str, number: int) -> dict[str, Any]:
    first = _BOOTS[epoch][0]
    day = 1 + list(_BOOTS).index(epoch)
    words = (
        "restored after a restart: 1 hold" if number == first > 1 else f"thing {number} happened"
    )
    return {
        "type": "event",
        "epoch": epoch,
        "id": number,
        "at": f"2026-03-0{day}T12:{number // 60:02}:{number % 60:02}.000Z",
        "kind": "service.restored" if number == first > 1 else "test.happened",
        "cause": None,
        "actor": "",
        "data": {},
        "words": words,
        "notable": number % 3 > 0,
    }


LOG = [_event(epoch, number) for epoch, numbers in _BOOTS.items() for number in numbers]


def tell_earlier_runs(page: Page) -> list[str]:
    """Answer requests of the page for events from this log; return where they are noted."""
    asked: list[str] = []

    def answer(route: Route) -> None:
        asked.append(urlsplit(route.request.url).query)
        query = parse_qs(asked[-1])
        before, limit = int(query.get("before", [LAST + 1])[0]), int(query["limit"][0])
        items = [event for event in LOG if event["id"] < before][-limit:]
        gaps = [_GAP] if items and items[0]["id"] < _LOST < before else []
        found = {"epoch": "three", "oldest": 1, "newest": LAST, "gaps": gaps, "items": items}
        route.fulfill(body=json.dumps(found), content_type="application/json")

    page.route("**/events?*", answer)
    page.reload()
    return asked
