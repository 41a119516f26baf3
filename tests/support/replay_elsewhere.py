"""Replays the records in a folder, in a process of its own; prints what differs."""

import sys
from pathlib import Path

from service.codec.codec import STEPS
from service.replay import core_of_boot, replay
from tests.support.recorded_robot import BOOT


def main() -> None:
    """Replay each file of the folder that is named in the arguments."""
    for file in sorted(Path(sys.argv[1]).glob("*.jsonl")):
        steps = map(STEPS.decode, file.read_bytes().splitlines())
        difference = replay(core_of_boot(BOOT), steps).difference
        if difference is not None:
            print(file.name, difference.words)


if __name__ == "__main__":
    main()
