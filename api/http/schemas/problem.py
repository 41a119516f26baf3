"""Problem documents: how every refusal and every failure is answered (RFC 9457)."""

from pydantic import Field

from api.http.schemas.base import BlockerJson, FindingJson, Json


class BodyFault(Json):
    """One thing wrong in a body."""

    pointer: str = Field(description="RFC 6901; empty: the body as a whole, or the query")
    code: str
    message: str


class Problem(Json):
    """What was refused or went wrong, and why (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    code: str = Field(description="Stable")
    hint: str | None = None
    blockers: list[BlockerJson] | None = None
    available: list[str] | None = Field(default=None, description="What could be asked for instead")
    findings: list[FindingJson] | None = None
    errors: list[BodyFault] | None = None

    def as_json(self) -> str:
        """Return the document; members that do not apply are left out."""
        return self.model_dump_json(exclude_unset=True)
