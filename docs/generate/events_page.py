"""Events: every kind with its meaning and its data."""

from docs.generate.markdown import code, page, table
from domain.events.event import Event
from domain.events.kinds import EVENTS

_INTRODUCTION = """\
`GET /events?after=&limit=&kind=` reads events; `WS /ws` publishes them as they happen. `kind=task`
selects all kinds that begin with `task.`.

    {"type": "event", "epoch": "...", "id": 88, "at": "...", "kind": "change.succeeded",
     "cause": 87, "actor": "...", "data": {...}}

`cause` is the id of the event that caused this one, or `null` for an input from outside or from the
clock. `actor` is who made the request. Each start of the service has a new `epoch`, and ids restart
at 1. The newest 10,000 events are kept.

An *input* is recorded only when it has an effect; accepted requests are always recorded. So ten
readings a second that change nothing leave no trace ([why]).
A key with `?` is present only where it applies.

[why]: ../decisions/0007-an-input-is-recorded-when-something-follows-from-it.md"""


def events_page() -> str:
    """Return the page `events.md`."""
    rows = (
        (code(kind.kind), "input" if kind.is_input else "", _about(kind), _keys(kind))
        for kind in EVENTS.values()
    )
    return page("Events", _INTRODUCTION, table(("kind", "", "meaning", "data"), rows))


def _about(kind: type[Event]) -> str:
    return (kind.__doc__ or "").partition("\n")[0]


def _keys(kind: type[Event]) -> str:
    names = (f"{key}?" if key in kind.optional else key for key in kind.data_keys())
    return ", ".join(map(code, names))
