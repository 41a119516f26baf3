"""All path trackers by name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from domain.tracking.pure_pursuit import PurePursuit
from domain.tracking.stanley import Stanley
from domain.tracking.tracker import PathTracker
from domain.vehicle import VehicleLimits

TRACKERS: Mapping[str, Callable[[VehicleLimits], PathTracker]] = MappingProxyType(
    {
        "pure_pursuit": PurePursuit,
        "stanley": Stanley,
    }
)
