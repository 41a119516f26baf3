"""Long lists let others have their turn."""

import asyncio
import json
from collections.abc import Iterator

import pytest

from api.http.list_answers import joined, json_list


@pytest.mark.parametrize("count", [0, 1, 50, 51, 10_000])
async def test_all_items_are_there_in_order(count: int) -> None:
    answer = await json_list(map(str, range(count)))

    assert json.loads(bytes(answer.body)) == {"items": list(range(count))}


@pytest.mark.parametrize(
    ("length", "count", "turns"), [(100_000, 5, 5), (10_000, 40, 10), (100, 3_280, 10), (10, 50, 0)]
)
async def test_others_get_a_turn_by_the_length_of_what_was_made(
    length: int, count: int, turns: int
) -> None:
    made = 0
    seen_by_another: set[int] = set()

    def items() -> Iterator[str]:
        nonlocal made
        for _ in range(count):
            made += 1
            yield "0" * length

    async def another() -> None:
        while made < count:
            await asyncio.sleep(0)
            seen_by_another.add(made)

    other = asyncio.create_task(another())
    await asyncio.sleep(0)
    await joined(items())
    await other

    # It looks once more at the end, when all is made.
    assert len(seen_by_another | {count}) == max(turns, 1)
