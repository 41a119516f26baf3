"""What holds for every test: no task is left behind, and generated examples are reproducible."""

import asyncio
import inspect
import os
import signal
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from hypothesis import settings

_HERE = Path(__file__).parent

# Derandomized, so that a run fails for what was changed and never by luck; `make soak` looks for
# new examples. No deadline, since a busy machine is not a fault of the code under test.
settings.register_profile(
    "default", max_examples=50, deadline=None, derandomize=True, print_blob=True
)
settings.register_profile("soak", deadline=None, max_examples=5_000, print_blob=True)
settings.load_profile("soak" if os.environ.get("PILOTHOUSE_SOAK") == "1" else "default")

# What is started in the background of a shell ignores Ctrl-C and Ctrl-\, and so would all that it
# starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGQUIT) is signal.SIG_IGN:
    signal.signal(signal.SIGQUIT, signal.SIG_DFL)


@pytest.fixture(scope="session", autouse=True)
def _state_of_its_own(tmp_path_factory: pytest.TempPathFactory) -> None:
    """Keep the tests away from what the user's own robots remember."""
    os.environ["XDG_STATE_HOME"] = str(tmp_path_factory.mktemp("state"))


# What takes longest begins first, so that the workers end at about the same time.
_LONGEST_FIRST = ("browser", "docs", "process", "properties", "api", "ros2/test_interfaces.py")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Order the files for the workers of pytest-xdist; a single process keeps the usual order."""
    if hasattr(config, "workerinput"):
        items.sort(key=_rank)


def _rank(item: pytest.Item) -> int:
    path = item.path.relative_to(_HERE)
    begins = (rank for rank, first in enumerate(_LONGEST_FIRST) if path.is_relative_to(first))
    return next(begins, len(_LONGEST_FIRST))


@pytest.fixture
async def no_task_is_left_behind() -> AsyncIterator[None]:
    """Fail the test if asyncio tasks that it started, or its fixtures, outlive it."""
    before = asyncio.all_tasks()
    yield
    # One pass of the loop, in which tasks end that have nothing left to wait for.
    await asyncio.sleep(0)
    left = asyncio.all_tasks() - before - {asyncio.current_task()}
    for task in left:
        task.cancel()
    await asyncio.gather(*left, return_exceptions=True)
    if left:
        pytest.fail(
            f"tasks left running: {sorted(task.get_name() for task in left)}", pytrace=False
        )


@pytest.fixture(autouse=True)
def _leaked_tasks(request: pytest.FixtureRequest) -> None:
    # Only for coroutines: a synchronous test would pay for an event loop that it does not need.
    if inspect.iscoroutinefunction(getattr(request, "function", None)):
        request.getfixturevalue("no_task_is_left_behind")
