"""Blockers and reasons: why something cannot be done now, or the robot is in ERROR."""

from collections.abc import Iterator

from docs.generate.markdown import code, page, table
from docs.generate.source_scan import codes_given_to, codes_in, require_described
from domain.changes.admission import ADVISORY
from domain.health.signals import (
    DECLARED_BIT,
    ESTOP,
    RATIO,
    STALE_DATA,
    STALE_DATA_BIT,
    Condition,
    SignalKind,
    SignalSettings,
    default_signals,
)
from domain.timebase import to_seconds

_OF_CHANGES = {
    ESTOP: "A node would be activated, and ESTOP is on.",
    "FINALIZED": "A node is finalized: its process has to be started anew.",
    "ERROR_PROCESSING": "A node is processing an error; it soon says where it ended.",
    "UNREACHABLE": "Nothing is heard of a node.",
    "UNKNOWN_STATE": "A node has never said in which state it is.",
}
_WARNINGS = {
    "CLOCK_SKEW": "The stamps of a signal differ from our clock by more than a second.",
    "LATE_TICKS": "Frames were skipped: the machine is too busy.",
    "NO_AUTHENTICATION": "Everybody who reaches the service may use it.",
    "NO_POSE": "Nobody says where the vehicle is, so tasks are held.",
}

_INTRODUCTION = """\
A blocker says why a mode cannot be entered (`GET .../modes`) or why a change was refused (409). A
reason says why the robot is in ERROR (`GET /system_state`). Both have the same form:

| member | what it says |
|---|---|
| `code` | stable; the tables below |
| `message` | the same in words, with numbers and units |
| `path` | from the part that was asked down to the node where it lies; for an error, the signal |
| `value`, `threshold` | what is, and what it is compared with; `null` where there is none |
| `since_at` | since when |
| `root_cause` | whether it is a cause itself, and not what another one led to |"""

_SIGNALS = """\
`error_code` is the sum of the bits of all errors that are on. An error ends with its cause, but is
on for 0.2 s at least. All numbers can be set ([settings](settings.md)).
*for* counts from the last good reading, or from the start where there was none."""


def blockers_page() -> str:
    """Return the page `blockers.md`.

    Raises:
        UndescribedError: A code of the source is not described here, or the reverse.
    """
    of_changes = codes_in("domain/changes/admission.py") | {ESTOP}
    require_described("blockers", of_changes, set(_OF_CHANGES))
    require_described("warnings", codes_given_to("WarningJson"), set(_WARNINGS))
    changes = (
        (code(name), "no" if name in ADVISORY else "yes", about)
        for name, about in _OF_CHANGES.items()
    )
    warnings = ((code(name), about) for name, about in sorted(_WARNINGS.items()))
    return page(
        "Blockers, reasons and errors",
        _INTRODUCTION,
        "## Changes",
        table(("code", "refuses", "cause"), changes),
        "What refuses nothing is a warning: an absent node may be back before the deadline of the"
        "\nchange, which otherwise fails and names it.",
        "## Errors of signals",
        _SIGNALS,
        table(("error", "bit", "signal", "when"), _errors()),
        "## Warnings of `/healthz`",
        table(("code", "cause"), warnings),
    )


def _errors() -> Iterator[tuple[str, str, str, str]]:
    for settings in default_signals():
        for condition in settings.conditions:
            name = settings.spec.name
            yield code(condition.error), str(condition.bit), code(name), _when(settings, condition)
    stale = f"older than {to_seconds(default_signals()[0].stale_after):g} s, or never read"
    yield code(STALE_DATA), str(STALE_DATA_BIT), "any", stale
    yield "of a declared signal", str(DECLARED_BIT), "its own", "as declared in the robot file"


def _when(settings: SignalSettings, condition: Condition) -> str:
    spec = settings.spec
    if spec.kind is SignalKind.NUMBER:
        unit = "" if spec.unit == RATIO else f" {spec.unit}"
        words = f"{condition.comparison} {condition.threshold}{unit}"
    else:
        words = code(str(condition.threshold).lower() if spec.is_stop else f"{condition.threshold}")
    if condition.for_:
        words += f" for {to_seconds(condition.for_):g} s"
    return f"{words}, or the emergency stop is engaged" if spec.is_stop else words
