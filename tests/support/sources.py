"""Sources without devices: what they say is noted, and their threads run when a test lets them."""

import asyncio
from collections.abc import Callable
from types import SimpleNamespace
from typing import ClassVar, TypeVar

from domain.timebase import Duration, Instant

Result = TypeVar("Result")


class NotedSink:
    """A `Sink` that notes what it is given."""

    def __init__(self) -> None:
        self.taken: list[tuple[str, object]] = []
        self.failed: list[tuple[str, str]] = []
        self.stamps: list[Instant | None] = []
        self.durations: list[Duration] = []

    def take(self, signal: str, value: object, stamp: Instant | None = None) -> None:
        self.taken.append((signal, value))
        self.stamps.append(stamp)

    def fail(self, signal: str, why: str) -> None:
        self.failed.append((signal, why))

    def note_duration(self, duration: Duration) -> None:
        self.durations.append(duration)


class InlineThread:
    """In place of `CallThread`: makes its calls at once, in virtual time; or hangs."""

    hangs: ClassVar[bool] = False
    waiting: ClassVar[list[Callable[[], None]]] = []
    """The calls that hang; a test makes them go on."""
    ended: ClassVar[int] = 0

    def __init__(self, name: str) -> None:
        self.name = name

    def run(self, call: Callable[[], Result]) -> "asyncio.Future[Result]":
        future: asyncio.Future[Result] = asyncio.get_running_loop().create_future()

        def work() -> None:
            result = call()
            if not future.cancelled():
                future.set_result(result)

        if type(self).hangs:
            self.waiting.append(work)
        else:
            work()
        return future

    def end(self) -> None:
        type(self).ended += 1

    @classmethod
    def reset(cls) -> None:
        """Begin a test with threads that do not hang."""
        cls.hangs, cls.waiting, cls.ended = False, [], 0

    @classmethod
    def go_on(cls) -> None:
        """Let all calls that hang return."""
        cls.hangs = False
        waiting, cls.waiting = cls.waiting, []
        for work in waiting:
            work()


class Device:
    """What the fake libraries below talk to: one device, that answers with a number or fails."""

    def __init__(self) -> None:
        self.number = 0
        self.is_there = True
        self.opened: list[object] = []
        self.asked: list[object] = []
        self.closed = 0

    def open(self, what: object) -> None:
        self.require()
        self.opened.append(what)

    def ask(self, what: object) -> int:
        self.require()
        self.asked.append(what)
        return self.number

    def close(self) -> None:
        self.closed += 1

    def require(self) -> None:
        if not self.is_there:
            raise OSError(121, "Remote I/O error")


def fake_smbus2(device: Device) -> SimpleNamespace:
    """Return what is used of smbus2, with two-byte registers."""

    class SMBus:
        def __init__(self, bus: int) -> None:
            device.open(bus)

        def read_i2c_block_data(self, address: int, register: int, length: int) -> list[int]:
            return list(device.ask((address, register, length)).to_bytes(length, "big"))

        def close(self) -> None:
            device.close()

    return SimpleNamespace(SMBus=SMBus)


def fake_spidev(device: Device) -> SimpleNamespace:
    """Return what is used of spidev; the device answers after the bytes that it is sent."""

    class SpiDev:
        mode = 0
        max_speed_hz = 0

        def open(self, bus: int, number: int) -> None:
            device.open((bus, number))

        def xfer2(self, values: list[int]) -> list[int]:
            number = device.ask((self.mode, self.max_speed_hz, tuple(values)))
            return [0xFF] * (len(values) - 2) + list(number.to_bytes(2, "big"))

        def close(self) -> None:
            device.close()

    return SimpleNamespace(SpiDev=SpiDev)


def fake_gpiod(device: Device) -> tuple[SimpleNamespace, SimpleNamespace]:
    """Return what is used of gpiod 2, and of its module `line`."""
    bias = {"AS_IS": "as is", "DISABLED": "none", "PULL_UP": "up", "PULL_DOWN": "down"}
    line = SimpleNamespace(
        Bias=bias,
        Direction=SimpleNamespace(INPUT="input"),
        Value=SimpleNamespace(ACTIVE="active", INACTIVE="inactive"),
    )

    class Request:
        def get_value(self, number: object) -> str:
            return "active" if device.ask(number) else "inactive"

        def release(self) -> None:
            device.close()

    def request_lines(chip: str, *, consumer: str, config: dict[object, object]) -> Request:
        device.open((chip, consumer, config))
        return Request()

    return SimpleNamespace(
        LineSettings=lambda **settings: settings, request_lines=request_lines, line=line
    ), line


def fake_systemd_bus(device: Device) -> SimpleNamespace:
    """Return what is used of our module `systemd_bus`: units that are active if the number is 1."""

    class ServiceManager:
        def __init__(self, manager: str) -> None:
            device.open(manager)

        def states(self, unit: str) -> tuple[str, str]:
            number = device.ask(unit)
            return "loaded", "active" if number else "failed"

        def restarts(self, unit: str) -> int:
            return device.ask(unit)

        def close(self) -> None:
            device.close()

    return SimpleNamespace(ServiceManager=ServiceManager)
