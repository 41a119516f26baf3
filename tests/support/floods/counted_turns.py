"""An event loop that counts what each of its turns does: a bound without a clock."""

import asyncio
import sys
from collections import Counter
from dataclasses import dataclass, field
from types import CodeType, FrameType


@dataclass(slots=True)
class Turn:
    """What one turn of the loop did."""

    calls: int = 0
    """Calls of functions, whether written in Python or in C, and resumed coroutines."""
    of: Counter[CodeType] = field(default_factory=Counter)
    """Those of functions written in Python, by their code."""

    def busiest(self, count: int = 8) -> str:
        """Return which functions were called most."""
        return ", ".join(f"{code.co_qualname} {n}" for code, n in self.of.most_common(count))


class CountedTurns(asyncio.SelectorEventLoop):
    """The loop."""

    def __init__(self) -> None:
        super().__init__()
        self.last = Turn()
        """The last one that is complete."""

    def _run_once(self) -> None:
        turn = Turn()
        of = turn.of

        def note(frame: FrameType, event: str, argument: object) -> None:
            if event == "call":
                turn.calls += 1
                of[frame.f_code] += 1
            elif event == "c_call":
                turn.calls += 1

        before = sys.getprofile()
        sys.setprofile(note)
        try:
            super()._run_once()  # type: ignore[misc]
        finally:
            sys.setprofile(before)
        self.last = turn
