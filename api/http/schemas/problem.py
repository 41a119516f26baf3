"""Problem documents: the answer to every rejection and failure (RFC 9457)."""

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from api.http.schemas.base import BlockerJson, FindingJson, Json, left_out


class BodyFault(Json):
    """One error in a body."""

    pointer: str = Field(description="JSON pointer (RFC 6901); empty: the whole body, or the query")
    code: str
    message: str


class WithIgnored(Json):
    """What was taken although a part of it is invalid."""

    ignored: list[BodyFault] | SkipJsonSchema[None] = Field(
        default=None,
        description="What was ignored, so that a stop or hold could be taken; left out: nothing",
        json_schema_extra=left_out,
    )


class Problem(Json):
    """What was rejected or failed, and why (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    code: str = Field(description="Stable identifier of the kind of problem")
    hint: str | None = None
    blockers: list[BlockerJson] | None = None
    available: list[str] | None = Field(default=None, description="Values that would be accepted")
    findings: list[FindingJson] | None = None
    errors: list[BodyFault] | None = None

    def as_json(self) -> str:
        """Return the document; members that do not apply are left out."""
        return self.model_dump_json(exclude_unset=True)
