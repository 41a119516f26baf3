"""Long lists let others have their turn."""

import asyncio
import json
from collections.abc import Iterator

import pytest

from api.long_lists import json_list


@pytest.mark.parametrize("count", [0, 1, 50, 51, 1_000])
async def test_all_items_are_there_in_order(count: int) -> None:
    answer = await json_list(map(str, range(count)))

    assert json.loads(bytes(answer.body)) == {"items": list(range(count))}


async def test_others_get_their_turn_while_a_long_list_is_made() -> None:
    made = 0
    seen_by_another = []

    def items() -> Iterator[str]:
        nonlocal made
        while made < 1_000:
            made += 1
            yield "0"

    async def another() -> None:
        while made < 1_000:
            seen_by_another.append(made)
            await asyncio.sleep(0)

    await asyncio.gather(json_list(items()), another())

    assert len(seen_by_another) >= 10
