import os

import pytest

from domain.errors import UnknownPartError
from service.jobs import InlineJobs, Jobs
from service.worker import Worker


def refuse(name: str) -> None:
    raise UnknownPartError("node", name, ["drive_base"])


async def test_a_job_is_done_here() -> None:
    assert await InlineJobs().call(os.getpid) == os.getpid()


async def test_a_job_gets_its_arguments() -> None:
    assert await InlineJobs().call(divmod, 7, 3) == (2, 1)


async def test_what_a_job_refuses_is_refused() -> None:
    with pytest.raises(UnknownPartError, match="there is no node 'x'"):
        await InlineJobs().call(refuse, "x")


async def test_there_is_nothing_to_close() -> None:
    jobs = InlineJobs()
    await jobs.close()

    assert await jobs.call(abs, -1) == 1


async def test_whoever_does_jobs_takes_them_in_the_same_way() -> None:
    everybody: list[Jobs] = [InlineJobs(), Worker()]
    for jobs in everybody:
        try:
            assert await jobs.call(divmod, 7, 3) == (2, 1)
            with pytest.raises(UnknownPartError):
                await jobs.call(refuse, "x")
        finally:
            await jobs.close()
