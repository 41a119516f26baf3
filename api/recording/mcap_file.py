"""A file of MCAP, which Foxglove and Lichtblick show; the only module that needs mcap."""

import json
import os
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Any, Self


class NoMcapError(Exception):
    """mcap is not installed; the message says how to get it."""


def require_mcap() -> None:
    """Check that mcap is there; it is not loaded yet.

    Raises:
        NoMcapError: It is not installed.
    """
    if find_spec("mcap") is None:
        raise NoMcapError("this needs mcap: install pilothouse[recording]")


class McapFile:
    """A file that grows beside its place, and is put there when it is complete.

    Args:
        path: Where it is then.
        library: What writes it.
    """

    def __init__(self, path: Path, library: str) -> None:
        self._path = path
        self._growing = path.with_name(f"{path.name}.part")
        self._library = library
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self.messages = 0

    def __enter__(self) -> Self:
        """Begin the file.

        Raises:
            NoMcapError: mcap is not installed.
            OSError: It cannot be written.
        """
        require_mcap()
        from mcap.writer import CompressionType, Writer

        self._file = self._growing.open("wb")
        self._writer: Writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library=self._library)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Put the file in its place; if it could not be completed, there is none."""
        try:
            if error is None:
                self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.close()
            if error is None:
                os.replace(self._growing, self._path)
        finally:
            self._growing.unlink(missing_ok=True)

    def has(self, topic: str) -> bool:
        """Tell whether there is a channel of that topic."""
        return topic in self._channels

    def add_channel(self, topic: str, kind: str, schema: Mapping[str, Any]) -> None:
        """Add a channel of JSON.

        Args:
            topic: Of the channel; a new one.
            kind: Name of the schema.
            schema: JSON Schema of its messages.
        """
        if kind not in self._schemas:
            text = json.dumps(schema).encode()
            self._schemas[kind] = self._writer.register_schema(kind, "jsonschema", text)
        channel = self._writer.register_channel(topic, "json", self._schemas[kind])
        self._channels[topic] = channel

    def write(self, topic: str, at_ns: int, message: Mapping[str, Any]) -> None:
        """Write a message.

        Args:
            topic: Of a channel.
            at_ns: When it was, ns since 1970 UTC.
            message: Fits the schema of the channel.
        """
        data = json.dumps(message, separators=(",", ":")).encode()
        self._writer.add_message(self._channels[topic], at_ns, data, at_ns, self.messages)
        self.messages += 1
