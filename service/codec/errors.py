"""The error of records that cannot be written or read."""

from domain.errors import PilothouseError


class CodecError(PilothouseError):
    """A record that is not one of the core's values, or a value that is no record.

    Args:
        message: What is wrong.
        place: Fields and indexes that lead there, from the outside inwards.
    """

    code = "INVALID_RECORD"

    def __init__(self, message: str, place: tuple[str | int, ...] = ()) -> None:
        where = "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in place)
        super().__init__(f"{where.lstrip('.')}: {message}" if place else message)
        self.fault = message
        self.place = place

    def inside(self, step: str | int) -> "CodecError":
        """Return the same error, seen from one level further out."""
        return CodecError(self.fault, (step, *self.place))
