"""Errors that a model file declares for a part, beside the built-in ones."""

from dataclasses import dataclass

from domain.conditions.condition import Condition
from domain.snapshot import ErrorKey, Severity
from domain.timebase import Duration


@dataclass(frozen=True, slots=True)
class DeclaredError:
    """What a model file says about one error of a part.

    With `when`, the error is detected; with `caused_by` alone, it follows; with neither, it is
    reported. A declaration under the name of a built-in error, or of one that a signal of the part
    raises, sets what is said and nothing else.
    """

    when: Condition | None = None
    """While it is true, the cause is present; None: nobody looks for it."""
    for_: Duration = 0
    """How long `when` has to be true before the error is raised."""
    clear_for: Duration = 0
    """How long `when` has to be false before the error clears."""
    caused_by: tuple[ErrorKey, ...] = ()
    """The errors that explain this one, or that it follows from."""
    need_all: bool = False
    """It follows once all its causes are on; False: once one of them is."""
    unless: Condition | None = None
    """While it is true, the error does not follow."""
    after: Duration = 0
    """How long the causes have to be on before the error follows."""
    expected_within: Duration | None = None
    """A cause that is on for so long should have had this effect; None: it need not have."""
    severity: Severity | None = None
    """None: that of the built-in error, or else `warning`."""
    needs_acknowledgement: bool = False
    """The error stays on until an operator has acknowledged it."""
    suppressed_when: Condition | None = None
    """While it is true, the error is not announced."""
    message: str = ""
    """What it means, in words; empty: its condition or its causes say so."""
    hint: str = ""
    """What to do about it."""

    @property
    def says_how(self) -> bool:
        """Tell whether it says how the error is found or follows, and not just what it means."""
        is_found = self.when is not None or self.for_ or self.clear_for
        return bool(is_found or self.unless is not None or self.after or self.need_all)
