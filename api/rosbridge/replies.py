"""Texts of the messages to rosbridge clients."""

from collections.abc import Mapping
from typing import Any

from pydantic_core import to_json

from domain.errors import PilothouseError
from service.ros.interface.endpoints import Fields


def status_text(level: str, message: str, id_: str | int | None) -> str:
    """Return a status message about an operation.

    Args:
        level: `error`, `warning` or `info`.
        message: A sentence.
        id_: Of the operation; None: it had none.
    """
    return _json({"op": "status", "level": level, "msg": message, **_id_member(id_)})


def response_text(service: str, values: Fields | str, result: bool, id_: str | int | None) -> str:
    """Return the response to a service call.

    Args:
        service: As the client named it.
        values: The response, or why the call failed.
        result: Whether the call succeeded.
        id_: Of the call; None: it had none.
    """
    return _json(
        {
            "op": "service_response",
            "service": service,
            "values": values,
            "result": result,
            **_id_member(id_),
        }
    )


def sentence(error: PilothouseError) -> str:
    """Return an error as one text, with its hint."""
    return error.message if error.hint is None else f"{error.message} ({error.hint})"


class PublishedTexts:
    """Texts of published messages; a message for several clients is encoded once."""

    def __init__(self) -> None:
        self._newest: dict[str, tuple[Fields, str]] = {}

    def text(self, name: str, topic: str, message: Fields) -> str:
        """Return a message of a topic as text.

        Args:
            name: Full name of the topic.
            topic: Name of the topic as the client wrote it.
            message: The object that all listeners got.
        """
        known = self._newest.get(name)
        if known is None or known[0] is not message:
            known = self._newest[name] = (message, _json(message))
        return f'{{"op":"publish","topic":{_json(topic)},"msg":{known[1]}}}'


def _json(value: Mapping[str, Any] | str) -> str:
    """Return JSON; numbers that are not finite become null, since JSON cannot hold them."""
    return to_json(value, inf_nan_mode="null").decode()


def _id_member(id_: str | int | None) -> Mapping[str, Any]:
    return {} if id_ is None else {"id": id_}
