"""What only a device may say: readings of its signals, and reported errors of its parts.

What a device repeats each second is no news to the supervisor's core. So what somebody says of it
at the supervisor would stand there until it changes at the device: a hot motor would be shown as
cold, while the device cools it down.
"""

from collections.abc import Collection, Iterable

from domain.computers import ComputerName
from domain.devices.settings import DeviceSettings
from domain.errors import ActsElsewhereError
from domain.health.error_list import ErrorList
from domain.health.signals import ESTOP_SIGNAL, asks_for_stop
from domain.inputs import ErrorReport, Input, Reading, Readings
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName


class OwnedFacts:
    """Knows which device a reading or a report belongs to."""

    def __init__(
        self, devices: Iterable[DeviceSettings], model: SmhModel, errors: ErrorList
    ) -> None:
        """Prepare.

        Args:
            devices: All devices of the robot.
            model: Of the whole robot.
            errors: Tells which errors are reported; what else is said of one is judged elsewhere.
        """
        self._devices = tuple(devices)
        self._readers = {signal: each.name for each in self._devices for signal in each.signals}
        self._model = model
        self._errors = errors

    def check_said_here(self, given: Input) -> None:
        """Check that an input that did not come from a device is not a device's to say.

        A stop that is asked for is everybody's: it is taken wherever the button is read.

        Raises:
            ActsElsewhereError: A device reads the signal, or owns the part with the error.
        """
        match given:
            case Readings():
                for item in given.items:
                    reader = self._readers.get(item.signal)
                    if reader is not None and not _is_stop(item):
                        raise ActsElsewhereError.of_signal(item.signal, reader)
            case ErrorReport(part=part, error=error) if part is not None and part in self._model:
                key = ErrorKey(part, error)
                owner = self._owner(part)
                if owner is not None and self._errors.causes.is_reported(key):
                    raise ActsElsewhereError.of_error(key.name, owner)
            case _:
                pass

    def _owner(self, part: PartName) -> ComputerName | None:
        """Return the device that all of a part is on; None: it is the supervisor's."""
        owners = (each.name for each in self._devices if is_own(part, each.nodes, self._model))
        return next(owners, None)


def _is_stop(item: Reading) -> bool:
    return item.signal == ESTOP_SIGNAL and asks_for_stop(item.value)


def is_own(part: PartName, nodes: Collection[PartName], model: SmhModel) -> bool:
    """Tell whether a part consists of nodes of a device alone."""
    below = _all_below(part, model)
    return bool(below) and below <= set(nodes)


def _all_below(part: PartName, model: SmhModel) -> set[PartName]:
    """Return the nodes below a part, those included that only some modes name."""
    found: set[PartName] = set()
    waiting, seen = [part], {part}
    while waiting:
        name = waiting.pop()
        if name in model.nodes:
            found.add(name)
            continue
        further = set(model.systems[name].named_parts) - seen
        seen |= further
        waiting.extend(further)
    return found
