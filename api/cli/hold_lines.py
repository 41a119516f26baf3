"""A hold as a line of text."""

from api.client.outcomes import Json


def hold_line(hold: Json) -> str:
    """Return who holds the task, why, and since when."""
    reason = f": {hold['reason']}" if hold["reason"] else ""
    return f"held by {hold['owner']}{reason}  [since {hold['since_at']}]"
