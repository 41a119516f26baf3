"""Events: every kind with what it means and what it carries."""

from docs.generate.markdown import code, page, table
from domain.events import EVENTS, Event

_INTRODUCTION = """\
`GET /events?after=&limit=&kind=` reads them, `WS /ws` sends them as they happen. `kind=task` stands
for all kinds that begin with `task.`.

    {"type": "event", "epoch": "...", "id": 88, "at": "...", "kind": "change.succeeded",
     "cause": 87, "actor": "...", "data": {...}}

`cause` is the id of the event that led to this one; `null`: it came from outside, or from the
clock. `actor` says who asked. `epoch` is another one after each start of the service, and ids begin
at 1 again. The newest 10,000 are kept.

An *input* is recorded when something follows from it; requests that are accepted always are. So ten
readings a second that change nothing leave no trace ([why]).
A key with `?` is there only where it applies.

[why]: ../decisions/0007-an-input-is-recorded-when-something-follows-from-it.md"""


def events_page() -> str:
    """Return the page `events.md`."""
    rows = (
        (code(kind.kind), "input" if kind.is_input else "", _about(kind), _keys(kind))
        for kind in EVENTS.values()
    )
    return page("Events", _INTRODUCTION, table(("kind", "", "what happened", "data"), rows))


def _about(kind: type[Event]) -> str:
    return (kind.__doc__ or "").partition("\n")[0]


def _keys(kind: type[Event]) -> str:
    names = (f"{key}?" if key in kind.optional else key for key in kind.data_keys())
    return ", ".join(map(code, names))
