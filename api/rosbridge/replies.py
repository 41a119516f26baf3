"""The text of what clients of rosbridge are sent."""

from collections.abc import Mapping
from typing import Any

from pydantic_core import to_json

from domain.errors import PilothouseError
from service.ros.interface.endpoints import Fields


def status_text(level: str, message: str, id_: str | int | None) -> str:
    """Return a status: what went wrong with the operation of that id.

    Args:
        level: `error`, `warning` or `info`.
        message: A sentence.
        id_: None: the operation had none.
    """
    return _json({"op": "status", "level": level, "msg": message, **_id_member(id_)})


def response_text(service: str, values: Fields | str, result: bool, id_: str | int | None) -> str:
    """Return the answer to a call.

    Args:
        service: As the client named it.
        values: The response, or why there is none.
        result: Whether there is one.
        id_: None: the call had none.
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
    """Texts of published messages; one that goes to several clients is encoded once."""

    def __init__(self) -> None:
        self._newest: dict[str, tuple[Fields, str]] = {}

    def text(self, name: str, topic: str, message: Fields) -> str:
        """Return a message of a topic as it is sent.

        Args:
            name: Of the topic, in full.
            topic: The same, as the client named it.
            message: The object that was handed to all who listen.
        """
        known = self._newest.get(name)
        if known is None or known[0] is not message:
            known = self._newest[name] = (message, _json(message))
        return f'{{"op":"publish","topic":{_json(topic)},"msg":{known[1]}}}'


def _json(value: Mapping[str, Any] | str) -> str:
    """Return JSON; what is not finite is null, since no client could read the rest otherwise."""
    return to_json(value, inf_nan_mode="null").decode()


def _id_member(id_: str | int | None) -> Mapping[str, Any]:
    return {} if id_ is None else {"id": id_}
