"""The block `link` of a robot file: how the computers of a robot reach each other."""

from typing import Annotated, Self, TypeAlias

from pydantic import Field, model_validator

from domain.timebase import Duration, seconds
from service.files.settings_block import SettingsBlock

# The length apart: in a pattern, a bound of 240 takes 1.4 MB once it is compiled.
Endpoint: TypeAlias = Annotated[str, Field(pattern=r"^(tcp|udp|tls|quic)/\S+$", max_length=245)]
_Path: TypeAlias = Annotated[str, Field(min_length=1, max_length=4_096)]


class LinkBlock(SettingsBlock):
    """The link between the computers of a robot. Without effect while there are no `devices`."""

    listen: Annotated[list[Endpoint], Field(max_length=16)] = Field(default_factory=list)
    """Where the supervisor listens, such as `quic/0.0.0.0:7447`. Default: on loopback only, for
    devices on the same computer."""
    connect: Annotated[list[Endpoint], Field(max_length=16)] = Field(default_factory=list)
    """Where devices find the supervisor, such as `quic/10.0.0.1:7447`. Default: on loopback."""
    ca: _Path | None = None
    """File of the certificate authority that signed the certificates of all computers, PEM."""
    certificate: _Path | None = None
    """File of this computer's certificate, PEM; its name is the name of the computer. `{name}` in
    the path stands for that name, so that all computers can have the same robot file."""
    key: _Path | None = None
    """File of the private key of the certificate, PEM; `{name}` as for the certificate."""
    late_s: Annotated[float, Field(ge=0.2, le=10, allow_inf_nan=False)] = 0.5
    """A computer that was not heard for so long is late, in seconds; each speaks ten times a
    second."""
    lost_s: Annotated[float, Field(ge=0.5, le=60, allow_inf_nan=False)] = 1.5
    """A computer that was not heard for so long, or did not hear us, is lost, in seconds: its nodes
    are unreachable, and nothing is commanded there."""

    @model_validator(mode="after")
    def _is_late_before_it_is_lost(self) -> Self:
        if self.late_s >= self.lost_s:
            raise ValueError("late_s must be less than lost_s")
        return self

    @model_validator(mode="after")
    def _has_all_of_a_certificate(self) -> Self:
        files = (self.ca, self.certificate, self.key)
        if any(file is not None for file in files) and None in files:
            raise ValueError("ca, certificate and key go together: give all or none of them")
        return self

    @property
    def late(self) -> Duration:
        """Return after which silence a computer is late."""
        return seconds(self.late_s)

    @property
    def lost(self) -> Duration:
        """Return after which silence a computer is lost."""
        return seconds(self.lost_s)
