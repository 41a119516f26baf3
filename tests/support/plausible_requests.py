"""What makes generated requests reach behind the first check: names that there are, and bodies that
look like models and waypoint files.
"""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from typing import Any

import schemathesis
import yaml
from hypothesis import strategies as st
from schemathesis import Case
from schemathesis.generation import GenerationMode

KNOWN: Mapping[str, Sequence[str]] = {
    "/systems": ("actuation",),
    "/nodes": ("drive_base", "manipulator"),
    "signal": ("battery_level", "estop", "gps_accuracy", "signal_strength", "temperature"),
    "error": ("ESTOP", "BATTERY_LOW", "STALE_DATA"),
    "owner": ("operator", "gate", "error"),
    "task": ("t1", "t2"),
    "change": ("c1", "c2"),
    "name": ("loop", "straight"),
}

_WORDS = (
    "active",
    "inactive",
    "active.FAST",
    "active.SLOW",
    "node",
    "system",
    "PID",
    "arm",
    "base",
)
_KEYS = st.sampled_from(
    ("arm", "base", "ros__parameters", "type", "modes", "rules", "parts", "__DEFAULT__", "FAST")
)
_LEAVES = st.one_of(
    st.sampled_from(_WORDS),
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(),
    st.text(max_size=8),
)
_TREES = st.recursive(
    _LEAVES,
    lambda inside: st.one_of(
        st.dictionaries(_KEYS, inside, max_size=5), st.lists(inside, max_size=3)
    ),
    max_leaves=25,
)
MODELS = st.one_of(_TREES.map(yaml.safe_dump).map(str.encode), st.binary(max_size=200))
"""Text that may be a model file."""

_NUMBERS = st.one_of(
    st.integers(-30, 30).map(str), st.floats().map(str), st.sampled_from(("", "x"))
)
_PLACES = st.integers(-30, 30).map(str)
_ROWS = st.lists(_PLACES, min_size=3, max_size=3) | st.lists(_NUMBERS, max_size=4)
_HEADERS = st.sampled_from(["", "x,y,yaw", "# s_m,x_m,y_m", "a,b,c", "lat,lon,alt", "x,y,width"])
_TABLES = st.tuples(_HEADERS, st.lists(_ROWS.map(",".join), max_size=12)).map(
    lambda file: "\n".join(line for line in (file[0], *file[1]) if line)
)
WAYPOINT_FILES = st.one_of(
    st.tuples(_TABLES, st.sampled_from([",", ";", "\t", " "])).map(
        lambda file: file[0].replace(",", file[1]).encode()
    ),
    st.binary(max_size=200),
)
"""Text that may be a waypoint file."""


def register() -> None:
    """Let bodies be made so, by their media type."""
    schemathesis.openapi.media_type("application/yaml", MODELS)
    schemathesis.openapi.media_type("text/csv", WAYPOINT_FILES)


def without_null_in_queries(document: dict[str, Any]) -> dict[str, Any]:
    """Return an OpenAPI document in which no parameter of a query may be null.

    A query is text. What is to be wrong because it is no null arrives as a word like any other, and
    is no fault if it is taken as one.
    """
    found = deepcopy(document)
    for methods in found["paths"].values():
        for operation in methods.values():
            for parameter in operation.get("parameters", ()):
                schema = parameter["schema"]
                choices = [one for one in schema.get("anyOf", ()) if one != {"type": "null"}]
                if len(choices) == 1:
                    del schema["anyOf"]
                    schema |= choices[0]
    return found


def name_what_there_is(case: "Case[Any]", number: int) -> None:
    """Put a name that there is into the path of every second request that is right by its form.

    Args:
        case: The request, changed in place.
        number: How many came before it.
    """
    meta = case.meta
    if number % 2 or meta is None or meta.generation.mode is not GenerationMode.POSITIVE:
        return
    for parameter in case.path_parameters:
        kind = f"/{case.path.split('/')[1]}" if parameter == "part" else parameter
        names = KNOWN.get(kind, ())
        if names:
            case.path_parameters[parameter] = names[number // 2 % len(names)]
