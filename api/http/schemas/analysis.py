"""Fault trees as clients see them."""

from collections.abc import Iterable
from typing import Literal

from pydantic import Field

from api.http.schemas.base import Json
from api.http.schemas.errors import ErrorNameJson
from domain.analysis.fault_trees import TOO_MANY_CUT_SETS, FaultTree
from domain.snapshot import ErrorKey, Severity


class IncompleteJson(Json):
    """Why not all cut sets are listed, and which are."""

    code: Literal["TOO_MANY_CUT_SETS"] = TOO_MANY_CUT_SETS
    message: str
    complete_to: int = Field(
        description="All cut sets of at most so many errors are listed, and no others"
    )


class FaultTreeJson(Json):
    """What leads to a critical or fatal error."""

    part: str | None = Field(description="null: the robot's own")
    error: str
    severity: Severity
    cut_sets: list[list[ErrorNameJson]] = Field(
        description=(
            "The smallest sets of detected, reported and built-in errors that raise it; of one"
            " error first: its single points of failure"
        )
    )
    incomplete: IncompleteJson | None = Field(description="null: all cut sets are listed")


class AnalysisJson(Json):
    """Fault trees: of the robot's own errors, then of those of its parts in file order."""

    errors: list[FaultTreeJson]

    @classmethod
    def of(cls, trees: Iterable[FaultTree]) -> "AnalysisJson":
        """Return the message for fault trees."""
        names: dict[ErrorKey, ErrorNameJson] = {}

        def name_of(key: ErrorKey) -> ErrorNameJson:
            if key not in names:
                names[key] = ErrorNameJson(part=key.part, error=key.error)
            return names[key]

        return cls(
            errors=[
                FaultTreeJson(
                    part=tree.key.part,
                    error=tree.key.error,
                    severity=tree.severity,
                    cut_sets=[list(map(name_of, errors)) for errors in tree.cut_sets],
                    incomplete=_incomplete(tree),
                )
                for tree in trees
            ]
        )


def _incomplete(tree: FaultTree) -> IncompleteJson | None:
    if tree.complete_to is None or tree.problem is None:
        return None
    return IncompleteJson(message=tree.problem, complete_to=tree.complete_to)
