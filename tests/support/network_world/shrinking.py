"""Makes a story shorter that shows a fault, so that it can be read."""

from collections.abc import Callable
from dataclasses import replace

from tests.support.network_world.stories import Story

MOST_TRIES = 60


def shortest(story: Story, fails: Callable[[Story], bool]) -> Story:
    """Leave out what the fault does not need, as far as some tries go.

    Args:
        story: One that fails.
        fails: Whether a story does.
    """
    tries, size = MOST_TRIES, max(len(story.happenings) // 2, 1)
    while tries > 0:
        at = 0
        while at < len(story.happenings) and tries > 0:
            kept = story.happenings[:at] + story.happenings[at + size :]
            tries -= 1
            if fails(shorter := replace(story, happenings=kept)):
                story = shorter
            else:
                at += size
        if size == 1:
            break
        size //= 2
    return story
