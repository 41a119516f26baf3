"""Reactions of parts as clients see them, and requests to them."""

from pydantic import Field

from api.http.schemas.base import (
    BlockerJson,
    Body,
    Json,
    StateAndModeJson,
    Timestamp,
    timestamp_or_none,
)
from domain.reaction_terms import Action, Arm, ReactionState, Until
from domain.reactions.reaction_view import ReactionView
from domain.timebase import to_seconds
from service.clock import Clock

MAX_REASON = 500


class ReactionJson(Json):
    """One reaction of a part."""

    reaction: str = Field(examples=["LIMP"], description="Unique in the model")
    part: str
    arm: Arm = Field(description="`passive`: it tells when it would act, and does nothing")
    state: ReactionState = Field(
        description=(
            "`overruled`: something calls for it, and something else keeps it from acting;"
            " `exhausted`: it acted too often, and waits for an acknowledgement;"
            " `passive`: it would act if it were active"
        )
    )
    action: Action
    target: StateAndModeJson | None = Field(description="null: the action has none")
    since_at: Timestamp | None = Field(description="null: since the start of the service")
    blockers: list[BlockerJson] = Field(
        description="What keeps it from acting, and what calls for it; empty: it is idle"
    )
    left: int | None = Field(
        description="How often it may act before its budget is used up; null: at any time"
    )
    when: str = Field(description="Its condition")
    for_s: float = Field(description="How long its condition has to be true")
    until: Until
    waits_for: str = Field(description="What has to happen next, in words")

    @classmethod
    def of(cls, view: ReactionView, clock: Clock) -> "ReactionJson":
        """Show `view`."""
        return cls(
            reaction=view.reaction,
            part=view.part,
            arm=view.arm,
            state=view.state,
            action=view.action,
            target=None if view.target is None else StateAndModeJson.of(view.target),
            since_at=timestamp_or_none(clock, view.since),
            blockers=[BlockerJson.of(blocker, clock) for blocker in view.blockers],
            left=view.left,
            when=view.when,
            for_s=to_seconds(view.lasts),
            until=view.until,
            waits_for=view.waits_for,
        )


class ReactionsJson(Json):
    """Reactions, in the order of the model file."""

    items: list[ReactionJson]


class ArmBody(Body):
    """Whether a reaction may act, and why that is said."""

    # Enumerations are sent as words.
    arm: Arm = Field(strict=False, examples=["passive"])
    reason: str = Field(default="", max_length=MAX_REASON)
