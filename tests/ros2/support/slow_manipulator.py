"""The manipulator of the examples, with an activation that takes its time.

python slow_manipulator.py SECONDS [--no-heartbeat]
"""

import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

NODES = Path(__file__).resolve().parents[3] / "examples" / "ros2" / "nodes"


def without_heartbeat(node: object) -> None:
    """Offer nothing."""


def main() -> None:
    """Run the node until it is killed."""
    sys.path.insert(0, str(NODES))
    if "--no-heartbeat" in sys.argv:
        import_module("heartbeat").offer_heartbeat = without_heartbeat  # type: ignore[attr-defined]
    manipulator = import_module("manipulator")

    class SlowManipulator(manipulator.Manipulator):  # type: ignore[misc, name-defined]
        """Takes its time to let go of the brakes."""

        def on_activate(self, previous: Any) -> Any:  # noqa: ANN401
            time.sleep(float(sys.argv[1]))
            return super().on_activate(previous)

    manipulator.Manipulator = SlowManipulator  # type: ignore[attr-defined]
    manipulator.main()


if __name__ == "__main__":
    main()
