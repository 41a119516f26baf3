"""Settings of sources: what the service itself reads a signal from."""

from typing import Annotated, Literal, Self, TypeAlias

from pydantic import ConfigDict, Field, model_validator

from service.files.settings_block import Number, SettingsBlock

MISSED_PERIODS = 3
"""A signal is stale after so many periods without a reading, unless its settings say otherwise."""

_Period: TypeAlias = Annotated[float, Field(ge=0.02, le=3_600, allow_inf_nan=False)]
_SlowPeriod: TypeAlias = Annotated[float, Field(ge=0.2, le=3_600, allow_inf_nan=False)]
_Path: TypeAlias = Annotated[str, Field(pattern=r"^/[^\x00]*$", max_length=1_024)]
_Name: TypeAlias = Annotated[str, Field(min_length=1, max_length=128, pattern=r"^[^\x00/]+$")]
_Cgroup: TypeAlias = Annotated[
    str, Field(max_length=1_024, pattern=r"^/?([^\x00/.][^\x00/]*)(/[^\x00/.][^\x00/]*)*$")
]
_Unit: TypeAlias = Annotated[
    str,
    Field(
        max_length=255,
        pattern=r"^[A-Za-z0-9:_.\\@-]+\.(service|socket|device|mount|target|timer|path|slice|scope)$",
    ),
]

OsQuantity: TypeAlias = Literal[
    "cpu_percent",
    "load_1",
    "load_5",
    "load_15",
    "load_per_core",
    "memory_percent",
    "memory_bytes",
    "memory_available_bytes",
    "swap_percent",
    "cpu_pressure_percent",
    "memory_pressure_percent",
    "io_pressure_percent",
    "disk_percent",
    "disk_free_bytes",
    "temperature_celsius",
    "network_received_bytes_per_s",
    "network_sent_bytes_per_s",
    "network_errors_per_s",
    "network_drops_per_s",
    "network_up",
    "clock_offset_s",
    "processes",
    "threads",
    "open_files",
    "oom_kills",
]

_OF_PROCESSES = frozenset(
    {"cpu_percent", "memory_percent", "memory_bytes", "processes", "threads", "open_files"}
)
_OF_CGROUPS = frozenset(
    {
        "cpu_percent",
        "memory_percent",
        "memory_bytes",
        "cpu_pressure_percent",
        "memory_pressure_percent",
        "io_pressure_percent",
        "processes",
        "oom_kills",
    }
)
_OF_NO_MACHINE = frozenset({"processes", "threads", "open_files", "oom_kills"})
_OF_DISKS = frozenset({"disk_percent", "disk_free_bytes"})
_OF_INTERFACES = frozenset(
    {
        "network_received_bytes_per_s",
        "network_sent_bytes_per_s",
        "network_errors_per_s",
        "network_drops_per_s",
        "network_up",
    }
)
_HEAVY_PERIOD_S = 10.0
_PERIOD_S = 1.0


class OsBlock(SettingsBlock):
    """A quantity of the computer that the service runs on.

    It is of the whole machine, or of the processes or the control group that are named.
    """

    what: OsQuantity
    """The quantity. CPU in percent of all cores together; pressure is the share of the last 10 s in
    which something waited; memory of processes is their proportional share (PSS); the clock offset
    is that to the time server. Without a measurement, such as that of the temperature on a virtual
    machine, the signal becomes stale."""
    process: _Name | None = None
    """Name of processes, as `top` shows it; what several have is added up."""
    cgroup: _Cgroup | None = None
    """Control group (version 2), such as system.slice/ros.service."""
    path: _Path = "/"
    """A folder on the disk."""
    interface: _Name | None = None
    """Network interface. Default: all but the loopback interface."""
    sensor: _Name | None = None
    """Name or label of a temperature sensor, as `sensors` shows it. Default: the hottest one."""
    period_s: _SlowPeriod | None = None
    """Seconds between two readings. Default: 1; of disks, temperatures, the clock and of processes
    10."""

    @property
    def seconds_between(self) -> float:
        """Return the period, in seconds."""
        if self.period_s is not None:
            return self.period_s
        return _HEAVY_PERIOD_S if self._is_heavy else _PERIOD_S

    @property
    def _is_heavy(self) -> bool:
        slow = _OF_DISKS | {"temperature_celsius", "clock_offset_s"}
        return self.what in slow or self.process is not None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if self.process is not None and self.cgroup is not None:
            raise ValueError("process and cgroup are mutually exclusive")
        if self.process is not None and self.what not in _OF_PROCESSES:
            raise ValueError(f"processes have no {self.what}")
        if self.cgroup is not None and self.what not in _OF_CGROUPS:
            raise ValueError(f"a control group has no {self.what}")
        if self.what in _OF_NO_MACHINE and self.process is None and self.cgroup is None:
            owners = "cgroup" if self.what not in _OF_PROCESSES else "process"
            raise ValueError(f"{self.what} requires {owners}")
        if self.what == "network_up" and self.interface is None:
            raise ValueError("network_up requires interface")
        for key, users in (
            ("path", _OF_DISKS),
            ("interface", _OF_INTERFACES),
            ("sensor", frozenset({"temperature_celsius"})),
        ):
            if key in self.model_fields_set and self.what not in users:
                raise ValueError(f"{self.what} has no {key}")
        return self


class SystemdBlock(SettingsBlock):
    """A unit of systemd; requires `pip install 'pilothouse[systemd]'`."""

    unit: _Unit
    """Name of the unit, with its ending."""
    what: Literal["active", "failed", "restarts"] = "active"
    """1 while the unit is active and 0 while it is not; the same of failed; or how often systemd
    restarted it."""
    manager: Literal["system", "user"] = "system"
    """Which service manager has the unit."""
    period_s: _SlowPeriod = 2.0
    """Seconds between two readings."""


class FileBlock(SettingsBlock):
    """A file that holds one number, as the kernel's hwmon, thermal and IIO sensors do."""

    path: _Path
    """Path of the file. An asterisk stands for what changes from start to start, such as the number
    in hwmon*; exactly one file must match."""
    scale: Number = 1.0
    """Factor, such as 0.001 for millidegrees."""
    offset: Number = 0.0
    """Added after scaling."""
    period_s: _Period = 1.0
    """Seconds between two readings."""


class GpioBlock(SettingsBlock):
    """An input line of a GPIO chip; requires `pip install 'pilothouse[gpio]'`.

    The reading is 1 while the line is active, and 0 while it is not.
    """

    chip: _Path = "/dev/gpiochip0"
    """Device of the chip."""
    line: Annotated[int, Field(ge=0, le=65_535)] | _Name
    """Number of the line on the chip, or its name."""
    active_low: bool = False
    """Whether a low level is active."""
    bias: Literal["as_is", "disabled", "pull_up", "pull_down"] = "as_is"
    """Bias of the line."""
    period_s: _Period = 0.1
    """Seconds between two readings."""


class RegisterBlock(SettingsBlock):
    """A whole number in the registers of a device, with scale and offset."""

    size_bytes: Annotated[int, Field(ge=1, le=4)] = 2
    """Number of bytes of the number."""
    order: Literal["big", "little"] = "big"
    """Which byte comes first: the most significant one (big) or the least significant one."""
    shift: Annotated[int, Field(ge=0, le=31)] = 0
    """Number of low bits that do not belong to the number."""
    bits: Annotated[int, Field(ge=1, le=32)] | None = None
    """Number of bits of the number, after shifting. Default: all that are left."""
    signed: bool = False
    """Whether it is in two's complement."""
    scale: Number = 1.0
    """Factor from the number to the unit of the signal."""
    offset: Number = 0.0
    """Added after scaling."""
    period_s: _Period = 1.0
    """Seconds between two readings."""

    @model_validator(mode="after")
    def _has_bits(self) -> Self:
        left = 8 * self.size_bytes - self.shift
        if left < 1 or (self.bits is not None and self.bits > left):
            raise ValueError(f"{self.size_bytes} bytes do not have so many bits")
        return self


class I2cBlock(RegisterBlock):
    """A register of a device on an I2C bus; requires `pip install 'pilothouse[i2c]'`.

    For a device whose driver is in the kernel, read its file instead.
    """

    bus: Annotated[int, Field(ge=0, le=1_023)]
    """Number of the bus: 1 for /dev/i2c-1."""
    address: Annotated[int, Field(ge=0x03, le=0x77)]
    """Address of the device, such as 0x40."""
    register_number: Annotated[int, Field(ge=0, le=0xFF, alias="register")]
    """Number of the register."""


class SpiBlock(RegisterBlock):
    """A number from a device on an SPI bus; requires `pip install 'pilothouse[spi]'`."""

    bus: Annotated[int, Field(ge=0, le=255)]
    """Number of the bus: 0 for /dev/spidev0.1."""
    device: Annotated[int, Field(ge=0, le=255)] = 0
    """Number of the device on the bus: 1 for /dev/spidev0.1."""
    send: Annotated[list[Annotated[int, Field(ge=0, le=0xFF)]], Field(min_length=1, max_length=16)]
    """Bytes to send, such as the number of a register; zeros follow while the answer is read."""
    skip: Annotated[int, Field(ge=0, le=16)] | None = None
    """Number of bytes of the answer before the number. Default: as many as are sent."""
    mode: Literal[0, 1, 2, 3] = 0
    """Polarity and phase of the clock."""
    max_speed_hz: Annotated[int, Field(ge=1_000, le=50_000_000)] = 500_000
    """Highest frequency of the clock."""


class HttpBlock(SettingsBlock):
    """Readings that a program posts, once in each period."""

    period_s: _Period
    """Longest time in seconds between two readings."""


class SourceBlock(SettingsBlock):
    """Where the readings of a signal come from: exactly one of these."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    os: OsBlock | None = None
    """A quantity of the computer."""
    systemd: SystemdBlock | None = None
    """A unit of systemd."""
    file: FileBlock | None = None
    """A file that holds one number."""
    gpio: GpioBlock | None = None
    """An input line of a GPIO chip."""
    i2c: I2cBlock | None = None
    """A register of a device on an I2C bus."""
    spi: SpiBlock | None = None
    """A number from a device on an SPI bus."""
    http: HttpBlock | None = None
    """Readings that a program posts."""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        kinds = tuple(type(self).model_fields)
        if sum(getattr(self, kind) is not None for kind in kinds) != 1:
            raise ValueError(f"a source is exactly one of {', '.join(kinds)}")
        return self

    @property
    def period_s(self) -> float:
        """Return how often it is read, in seconds."""
        if self.os is not None:
            return self.os.seconds_between
        others = (self.systemd, self.file, self.gpio, self.i2c, self.spi, self.http)
        return next(block.period_s for block in others if block is not None)
