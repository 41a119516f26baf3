"""Whether everything that supervises a robot goes on.

What feeds the watchdog of a service manager are the event loop, the core and the publishing of
frames, to the clients too, since only a restart mends these. A backend is not part of it: a restart
does not mend a robot that is silent, which is an error or a hold instead.
"""

from domain.timebase import Duration, Instant, seconds, to_seconds

LATE: Duration = seconds(1)
"""Whatever is so late hangs; the service is then not fit to supervise."""


def hanging(
    core_due: Instant | None,
    ticked_at: Instant | None,
    published_at: Instant | None,
    owing_since: Instant | None,
    now: Instant,
) -> str | None:
    """Return what hangs, in words; None: nothing.

    Args:
        core_due: When the core has its next deadline; None: there is none.
        ticked_at: When the last tick began; None: none has.
        published_at: When the last frame was published; None: none was.
        owing_since: Since when clients are not written what was published; None: nobody waits.
        now: The present.
    """
    if ticked_at is None or published_at is None:
        return "has not ticked yet"
    if now - ticked_at >= LATE:
        return f"last tick {to_seconds(now - ticked_at):.2f} s ago"
    if now - published_at >= LATE:
        return f"last frame {to_seconds(now - published_at):.2f} s ago"
    if owing_since is not None and now - owing_since >= LATE:
        return f"the stream has written nothing for {to_seconds(now - owing_since):.2f} s"
    if core_due is not None and now - core_due >= LATE:
        return f"a deadline of the core was missed by {to_seconds(now - core_due):.2f} s"
    return None
