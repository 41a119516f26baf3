"""How a program that serves a robot says why it did not start, or why it ends."""

import logging
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from api.terminal_text import complain, finding_line
from domain.findings import Finding
from service.ros.graph.graph import GraphFailedError, UnknownTypeError
from service.running import TaskFailedError

SUCCEEDED, FAILED, MISUSED = 0, 1, 2

log = logging.getLogger(__name__)


def tell_failure(failure: BaseException) -> None:
    """Log why the program ends; without a traceback if the user can fix the cause."""
    origins = [*_origins(failure)]
    if all(isinstance(origin, GraphFailedError | UnknownTypeError) for origin in origins):
        log.critical("%s", "; ".join(str(origin) for origin in origins))
    else:
        log.critical("%s", failure, exc_info=failure.__cause__ or failure)


def _origins(failure: BaseException) -> Iterator[BaseException]:
    """Yield what a failure goes back to; a task may fail because one of its own did."""
    if isinstance(failure, BaseExceptionGroup):
        for each in failure.exceptions:
            yield from _origins(each)
    elif isinstance(failure, TaskFailedError) and failure.__cause__ is not None:
        yield from _origins(failure.__cause__)
    else:
        yield failure


def leaves(group: BaseExceptionGroup[BaseException]) -> Iterator[BaseException]:
    """Yield the failures in a group, at any depth."""
    for failure in group.exceptions:
        if isinstance(failure, BaseExceptionGroup):
            yield from leaves(failure)
        else:
            yield failure


def end_with(message: str, code: int) -> int:
    """Complain, and return the exit code."""
    complain(message)
    return code


def complain_of(file: Path | None, findings: Sequence[Finding]) -> int:
    """Tell what is wrong in a file, and return the exit code."""
    for finding in findings:
        print(finding_line(str(file), finding), file=sys.stderr)
    return FAILED
