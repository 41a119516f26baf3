"""The computers of a robot as clients see them."""

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from api.http.schemas.base import Json, Timestamp, left_out, timestamp, timestamp_or_none
from domain.computers import Connection, DeviceState
from domain.devices.device_view import DeviceView
from domain.devices.lead_view import LeadView, Word
from domain.devices.settings import OfflineSettings
from domain.timebase import Instant, to_seconds
from service.clock import Clock


class OfflineJson(Json):
    """What a device does on its own while it is cut off, and nothing else."""

    after_s: float = Field(description="How long after the supervisor was last heard")
    target: dict[str, str] = Field(
        description="What is requested then, by part", examples=[{"drive_base": "inactive"}]
    )
    reactions: bool = Field(description="Whether its reactions act then")

    @classmethod
    def of(cls, settings: OfflineSettings) -> "OfflineJson":
        """Show `settings`."""
        return cls(
            after_s=to_seconds(settings.after),
            target={part: target.label for part, target in settings.targets.items()},
            reactions=settings.reactions,
        )


class DeviceJson(Json):
    """One device of the robot, as its supervisor sees it."""

    device: str
    state: DeviceState = Field(
        description=(
            "`late`: not heard for a moment, commands still go out; `lost`: nothing is commanded,"
            " and what is known of its parts is old; `conflict`: whoever answers by this name must"
            " not be dealt with"
        )
    )
    reason: str = Field(description="Why it is not connected; empty: it is, or was never seen")
    since_at: Timestamp = Field(description="Since when it is in this state")
    parts: tuple[str, ...] = Field(description="Nodes that it owns: only it commands them")
    heard_at: Timestamp | None = Field(
        description=(
            "When it was last heard; in frames, as of the last change of the rest; null: not yet"
        )
    )
    incarnation: str | None = Field(
        description="Its run that is dealt with, or was last; null: none was yet"
    )
    session: str | None = Field(description="Session that commands to it carry; null: none")
    autonomous: bool = Field(description="It acts on its own, as `offline` says")
    offline: OfflineJson
    stops: tuple[str, ...] = Field(description="Emergency stops that are engaged on it")
    version: str | None = Field(description="Version of Pilothouse there; null: unknown")
    refused: str = Field(description="Why another process of its name is refused; empty: none is")

    @classmethod
    def of(cls, view: DeviceView, connection: Connection, clock: Clock) -> "DeviceJson":
        """Show `view`."""
        return cls(
            device=view.device,
            state=view.state,
            reason=view.reason,
            since_at=timestamp(clock, view.since),
            parts=view.parts,
            heard_at=timestamp_or_none(clock, connection.heard_at),
            incarnation=view.incarnation,
            session=view.session,
            autonomous=view.autonomous,
            offline=OfflineJson.of(view.offline),
            stops=view.stops,
            version=view.version,
            refused=view.refused,
        )


class ListedDeviceJson(DeviceJson):
    """One device of the robot, as its supervisor sees it now."""

    heard_age_s: float | None = Field(description="Time since it was last heard; null: never")

    @classmethod
    def at(
        cls, view: DeviceView, connection: Connection, clock: Clock, now: Instant
    ) -> "ListedDeviceJson":
        """Show `view` as it is at `now`."""
        heard = connection.heard_at
        return cls(
            **dict(DeviceJson.of(view, connection, clock)),
            heard_age_s=None if heard is None else to_seconds(now - heard),
        )


class ThisDeviceJson(Json):
    """The device that the service runs on, and whose word counts there."""

    device: str
    lead: Word = Field(
        description=(
            "Whose word counts. `nobody`: it was never connected since its start; `cut_off`: it"
            " waits until it may act on its own; `device`: it does what it does when it is cut off"
        )
    )
    supervisor: DeviceState = Field(description="How the connection to the supervisor is")
    since_at: Timestamp = Field(description="Since when it is so")
    reason: str = Field(description="Why it is not connected; empty: it is")
    when_cut_off: str = Field(description="What it does on its own then, in words")

    @classmethod
    def of(cls, view: LeadView, clock: Clock) -> "ThisDeviceJson":
        """Show `view`."""
        return cls(
            device=view.device,
            lead=view.word,
            supervisor=view.supervisor,
            since_at=timestamp(clock, view.since),
            reason=view.reason,
            when_cut_off=view.offline,
        )


class DevicesJson(Json):
    """The other computers of the robot, in the order of the robot file."""

    items: list[ListedDeviceJson]
    this: ThisDeviceJson | SkipJsonSchema[None] = Field(
        default=None,
        description="On a device: which it is, and whose word counts there; else left out",
        json_schema_extra=left_out,
    )
