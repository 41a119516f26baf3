"""The report of a fault tree analysis, for people."""

from collections.abc import Iterator, Sequence
from itertools import groupby

from api.terminal_text import counted, visible
from domain.analysis.fault_trees import TOO_MANY_CUT_SETS, FaultTree

MAX_LINES = 50
"""Cut sets that are shown of as many errors each; of one top error."""


def report_lines(name: str, trees: Sequence[FaultTree]) -> Iterator[str]:
    """Yield the lines of a report: errors with single points of failure come first.

    Args:
        name: Of the model file.
        trees: What leads to each critical or fatal error.
    """
    followed = [tree for tree in trees if not tree.is_basic]
    yield f"Fault trees of {visible(name)}"
    yield f"  {counted(len(trees), 'critical or fatal error')}; {_single_points(followed)}"
    for tree in sorted(followed, key=_fewest):
        yield ""
        yield f"{visible(tree.key.name)} ({tree.severity}): {_how_many(tree)}"
        yield from _lines(tree)
    basic = [tree for tree in trees if tree.is_basic]
    if basic:
        yield ""
        yield "Detected, reported or built in, so that no other error leads to them:"
        yield from (f"  {visible(tree.key.name)} ({tree.severity})" for tree in basic)


def _single_points(followed: Sequence[FaultTree]) -> str:
    if not followed:
        return "none follows from others"
    count = sum(bool(tree.single_points) for tree in followed)
    return f"{len(followed)} of them follow from others, {count} of these from a single one"


def _fewest(tree: FaultTree) -> int:
    """Return how many errors it takes at least."""
    return len(tree.cut_sets[0]) if tree.cut_sets else (tree.complete_to or 0) + 1


def _how_many(tree: FaultTree) -> str:
    if tree.complete_to is None:
        return counted(len(tree.cut_sets), "minimal cut set")
    return f"too many minimal cut sets, {len(tree.cut_sets):,} of which are known"


def _lines(tree: FaultTree) -> Iterator[str]:
    for size, of_size in groupby(tree.cut_sets, key=len):
        errors = list(of_size)
        yield f"  {'single points of failure' if size == 1 else f'{size} errors together'}:"
        for each in errors[:MAX_LINES]:
            yield f"    {' + '.join(visible(key.name) for key in each)}"
        if len(errors) > MAX_LINES:
            yield f"    and {len(errors) - MAX_LINES:,} more, which --format json lists"
    if tree.problem is not None:
        yield f"  {TOO_MANY_CUT_SETS}: {visible(tree.problem)}"
