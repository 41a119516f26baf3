"""Whatever goes wrong between the computers of a robot: no node has two masters, no order of before
a cut is carried out after it, every stop is known, and in the end all agree on what is.

`make soak` tells 10,000 stories, `make test` 500. A story that fails is told again by its number:
`PILOTHOUSE_STORY=1234 .venv/bin/pytest tests/properties/test_several_computers.py`.
"""

import os

import pytest

from tests.support.network_world.stories import story_of
from tests.support.network_world.told import tell

ONE = os.environ.get("PILOTHOUSE_STORY")
SOAK = os.environ.get("PILOTHOUSE_SOAK") == "1"
STORIES = [int(ONE)] if ONE else range(10_000 if SOAK else 500)


@pytest.mark.parametrize("number", STORIES)
def test_all_computers_agree_in_the_end_and_nothing_moves_by_an_old_order(number: int) -> None:
    tell(story_of(number))
