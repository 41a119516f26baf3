"""Strategies for what may stand around a stop: any members, objects, lists, and duplicates."""

import json

from hypothesis import strategies as st

ANY = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda below: (
        st.lists(below, max_size=3) | st.dictionaries(st.text(max_size=6), below, max_size=3)
    ),
    max_leaves=6,
)
NAMES = st.sampled_from(
    ["stamp", "source", "reason", "header", "seq", "value", "engaged", "estop", "type", "signal"]
)
MEMBERS = st.lists(st.tuples(NAMES | st.text(max_size=6), ANY), max_size=5)
"""Members of an object, in which a name may occur several times."""
ASKING = st.sampled_from([True, 1, 1.0, "true", "TRUE", "yes", " On "])
"""Values that ask for a stop."""
WRAPPED = st.sampled_from(["%s", "%s", "[%s]", '{"msg":%s}', '[0,{"x":[%s]}]', "%s}", "\ufeff%s"])
"""What may stand around the object itself."""


def object_of(members: list[tuple[str, object]]) -> str:
    """Return JSON in which a name may occur several times."""
    inner = ",".join(f"{json.dumps(name)}:{json.dumps(value)}" for name, value in members)
    return f"{{{inner}}}"
