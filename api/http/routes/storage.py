"""Storage: where what survives a restart is kept, and how that is doing."""

from datetime import datetime

from fastapi import APIRouter
from pydantic import Field

from api.http.dependencies import SupervisorDep
from api.http.route_policy import Permission, policy
from api.http.schemas.base import Json, Timestamp, rfc3339
from service.storage.journal import LogStatus, StorageStatus
from service.storage.trends.trends import TrendsStatus

router = APIRouter(tags=["service"])


class LogJson(Json):
    """The extent of one log."""

    from_at: Timestamp | None
    to_at: Timestamp | None
    bytes: int

    @classmethod
    def of(cls, status: LogStatus) -> "LogJson":
        """Show `status`."""
        return cls(
            from_at=_shown(status.from_at),
            to_at=_shown(status.to_at),
            bytes=status.bytes,
        )


class HistoryJson(Json):
    """How the history of the signals is doing."""

    bytes: int
    lost_readings: int = Field(description="Readings of this run that it does not have")
    reason: str | None = Field(description="Why it cannot be written; null: it can")

    @classmethod
    def of(cls, status: TrendsStatus) -> "HistoryJson":
        """Show `status`."""
        return cls(bytes=status.bytes, lost_readings=status.dropped, reason=status.reason)


class StorageJson(Json):
    """How storage is doing."""

    path: str = Field(description="The folder; `:memory:`: nothing survives a restart")
    bytes: int
    free_bytes: int | None = Field(description="Free on the disk; null: unknown")
    degraded: bool
    reason: str | None = Field(description="Why it is degraded")
    library_version: str
    boot: int = Field(description="Number of this run, from 1")
    logs: dict[str, LogJson] = Field(description="`inputs` and `events`")
    lost_inputs: int = Field(description="Inputs of this run that could not be written down")
    lost_events: int
    history: HistoryJson | None = Field(description="Of the signals; null: there is none")

    @classmethod
    def of(cls, status: StorageStatus, history: TrendsStatus | None) -> "StorageJson":
        """Show the logs and the history of the signals."""
        return cls(
            path=status.path,
            bytes=status.bytes,
            free_bytes=status.free_bytes,
            degraded=status.reason is not None,
            reason=status.reason,
            library_version=status.library_version,
            boot=status.boot,
            logs={name: LogJson.of(log) for name, log in status.logs.items()},
            lost_inputs=status.lost_inputs,
            lost_events=status.lost_events,
            history=None if history is None else HistoryJson.of(history),
        )


@router.get("/storage")
@policy(Permission.OBSERVE)
async def get_storage(supervisor: SupervisorDep) -> StorageJson:
    """Show where state and logs are kept, how much there is, and whether storage works."""
    trends = supervisor.trends
    return StorageJson.of(supervisor.storage, None if trends is None else trends.status)


def _shown(moment: datetime | None) -> str | None:
    return None if moment is None else rfc3339(moment)
