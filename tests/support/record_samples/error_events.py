"""Values of the events of an error that is raised or ends."""

from collections.abc import Mapping

from domain.events.health import ErrorCleared, ErrorRaised
from domain.state_and_mode import PartName

ERROR_EVENTS: Mapping[str, tuple[object, ...]] = {
    "error.cleared": (
        ErrorCleared(error="LOW_BATTERY"),
        ErrorCleared(error="DEVIATES", part=PartName("arm")),
        ErrorCleared(error="SILENT", part=PartName("left/arm"), root_cause=False),
        ErrorCleared(error="SILENT", part=PartName("left/arm"), silenced=True),
        ErrorCleared(error="LOST", part=PartName("arm"), of_device=True),
    ),
    "error.raised": (
        ErrorRaised(error="LOW_BATTERY", message="12.5 % < 20 %", value=12.5, threshold=12.5),
        ErrorRaised(
            error="DEVIATES",
            message="arm is inactive, target active.FAST",
            value="inactive",
            threshold="active.FAST",
            part=PartName("arm"),
        ),
        ErrorRaised(
            error="SILENT",
            message="not part('left/arm').reachable",
            value=None,
            threshold=None,
            part=PartName("left/arm"),
            root_cause=False,
        ),
        ErrorRaised(
            error="LOW_BATTERY",
            message="12.5 % < 20 %",
            value=12.5,
            threshold=12.5,
            silenced=True,
        ),
        ErrorRaised(
            error="LOST",
            message="device arm is not connected: nothing heard for 1.5 s",
            value=None,
            threshold=None,
            part=PartName("arm"),
            of_device=True,
        ),
    ),
}
