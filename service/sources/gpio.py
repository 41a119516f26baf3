"""Input lines of a GPIO chip."""

from collections.abc import Mapping
from functools import partial

from domain.timebase import seconds
from service.clock import Clock
from service.files.source_block import GpioBlock
from service.sources.reopened import Reopened
from service.sources.sampled import Probe, SampledSource
from service.sources.source import from_extra

_CONSUMER = "pilothouse"
"""Who uses the lines, as `gpioinfo` shows it."""


def gpio_source(clock: Clock, chip: str, blocks: Mapping[str, GpioBlock]) -> SampledSource:
    """Return the source of one chip.

    Args:
        clock: Of the service.
        chip: Its device.
        blocks: The lines, by signal.
    """
    lines = {signal: Reopened(partial(_Line, block)) for signal, block in blocks.items()}
    probes = [
        Probe(signal, seconds(blocks[signal].period_s), partial(line.use, _Line.read))
        for signal, line in lines.items()
    ]

    def close() -> None:
        for line in lines.values():
            line.close()

    return SampledSource(f"gpio {chip}", probes, clock, close)


class _Line:
    """A line that is requested as an input; no other program can use it meanwhile."""

    def __init__(self, block: GpioBlock) -> None:
        with from_extra("gpio"):
            import gpiod
            from gpiod.line import Bias, Direction, Value
        settings = gpiod.LineSettings(
            direction=Direction.INPUT,
            active_low=block.active_low,
            bias=Bias[block.bias.upper()],
        )
        self._line = block.line
        self._active = Value.ACTIVE
        self._request = gpiod.request_lines(
            block.chip, consumer=_CONSUMER, config={block.line: settings}
        )

    def read(self) -> int:
        """Return 1 if the line is active, else 0."""
        return int(self._request.get_value(self._line) == self._active)

    def close(self) -> None:
        """Release the line."""
        self._request.release()
