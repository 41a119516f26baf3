"""Posts files at given times, in a process of its own, so that who measures only reads.

`python -m tests.support.posting HOST EVERY_S COUNT [PATH TYPE FILE] ...` prints of each post its
type, the status and size of the answer, and the seconds that it took, as JSON.
"""

import asyncio
import http.client
import json
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.support.bench import PROJECT
from tests.support.measured_service import module


@dataclass(frozen=True, slots=True)
class Posts:
    """What is posted: so many of path, content type and file, in turn."""

    count: int
    every_s: float
    items: Sequence[tuple[str, str, Path]]


@dataclass(frozen=True, slots=True)
class Posted:
    """How a post went."""

    content_type: str
    status: int
    answer_bytes: int
    took_s: float


class Posting:
    """A process that posts.

    Args:
        process: Has its output in a pipe.
    """

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    async def done(self) -> list[Posted]:
        """Wait until everything is posted, and return how that went."""
        output, _ = await self._process.communicate()
        return [Posted(*each) for each in json.loads(output)]


async def post(host: str, posts: Posts) -> Posting:
    """Begin to post to an address and port."""
    words = [str(word) for item in posts.items for word in item]
    arguments = (host, str(posts.every_s), str(posts.count), *words)
    return Posting(
        await asyncio.create_subprocess_exec(
            *module("tests.support.posting", *arguments),
            cwd=PROJECT,
            stdout=asyncio.subprocess.PIPE,
        )
    )


def _post_all(host: str, every_s: float, count: int, *words: str) -> Iterator[tuple[object, ...]]:
    begin = time.perf_counter()
    for number in range(count):
        path, kind, file = words[number % (len(words) // 3) * 3 :][:3]
        body = Path(file).read_bytes()
        time.sleep(max(0.0, begin + number * every_s - time.perf_counter()))
        start = time.perf_counter()
        connection = http.client.HTTPConnection(host)
        connection.request("POST", path, body, {"Content-Type": kind})
        answer = connection.getresponse()
        size = len(answer.read())
        yield kind, answer.status, size, time.perf_counter() - start
        connection.close()


if __name__ == "__main__":
    to, every, times, *rest = sys.argv[1:]
    json.dump(list(_post_all(to, float(every), int(times), *rest)), sys.stdout)
