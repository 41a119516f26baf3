import asyncio
import os
import signal
import sys
import time
from asyncio.subprocess import PIPE, Process
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import pytest

from domain.errors import UnknownPartError
from service.worker import (
    QUEUE_LENGTH,
    InlineJobs,
    JobFailedError,
    Jobs,
    TooComplexError,
    Worker,
    WorkerBusyError,
    WorkerClosedError,
)
from tests.support.waiting import until

HOLDER = """
import asyncio, os
from service.worker import Worker

async def main():
    print(await Worker().call(os.getpid), flush=True)
    await asyncio.sleep(60)

asyncio.run(main())
"""

BUSY_HOLDER = """
import asyncio, time
from service.worker import Worker

asyncio.run(Worker().call(exec, "import os, time; open({path!r}, 'w').write(str(os.getpid()));"
    "time.sleep(60)"))
"""
LIMITED = """
import asyncio
from service.worker import TooComplexError, Worker

async def main():
    worker = Worker(["domain.paths.path"])
    first = await worker.call(abs, -1)
    try:
        await worker.call(bytearray, 3 << 30)
    except TooComplexError as error:
        print(first, error.code, await worker.call(abs, -2))
    await worker.close()

asyncio.run(main())
"""


@pytest.fixture
async def worker() -> AsyncIterator[Worker]:
    made = Worker()
    yield made
    await made.close()


def is_imported(module: str) -> bool:
    return module in sys.modules


def wait_for_ever() -> None:
    while True:
        time.sleep(1)


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def take_all_memory() -> int:
    return len(bytearray(1 << 40))


def refuse(name: str) -> None:
    raise UnknownPartError("node", name, ["drive_base"])


def divide_by_zero() -> float:
    return 1 / 0


async def test_a_job_is_done_in_another_process(worker: Worker) -> None:
    assert await worker.call(os.getpid) != os.getpid()


async def test_what_jobs_need_is_imported_before_the_first_one() -> None:
    worker = Worker(modules=["wave"])
    try:
        assert await worker.call(is_imported, "wave")
    finally:
        await worker.close()


async def test_the_same_process_does_one_job_after_the_other(worker: Worker) -> None:
    first, second = await asyncio.gather(worker.call(os.getpid), worker.call(os.getpid))

    assert first == second


async def test_arguments_and_results_may_be_large(worker: Worker) -> None:
    text = "x" * 8_000_000

    assert await worker.call(str.upper, text) == "X" * 8_000_000


async def test_what_a_job_prints_does_not_get_between_the_results(worker: Worker) -> None:
    await worker.call(print, "hello")

    assert await worker.call(abs, -1) == 1


async def test_an_error_of_ours_arrives_as_it_was_raised(worker: Worker) -> None:
    with pytest.raises(UnknownPartError, match="there is no node 'x'") as raised:
        await worker.call(refuse, "x")

    assert (raised.value.name, raised.value.hint) == ("x", "known: drive_base")


async def test_a_fault_in_a_job_arrives_with_its_traceback_and_the_next_job_is_done(
    worker: Worker,
) -> None:
    with pytest.raises(JobFailedError, match="in divide_by_zero"):
        await worker.call(divide_by_zero)

    assert await worker.call(abs, -1) == 1


async def test_a_job_that_takes_too_long_is_ended_and_the_next_one_is_done() -> None:
    worker = Worker(deadline_s=1.0)
    try:
        with pytest.raises(TooComplexError, match="took longer than 1 s"):
            await worker.call(wait_for_ever)

        assert await worker.call(abs, -1) == 1
    finally:
        await worker.close()


@pytest.mark.parametrize(("job", "code"), [(die, "TOO_COMPLEX"), (take_all_memory, "MEMORY")])
async def test_a_job_that_ends_its_process_harms_only_itself(
    worker: Worker, job: Callable[[], object], code: str
) -> None:
    with pytest.raises(TooComplexError) as raised:
        await worker.call(job)
    assert raised.value.code == code

    assert await worker.call(abs, -1) == 1


async def test_a_process_that_died_while_idle_is_replaced(worker: Worker) -> None:
    first = await worker.call(os.getpid)
    os.kill(first, signal.SIGKILL)

    assert await worker.call(os.getpid) != first


async def test_a_queue_that_is_full_takes_no_more(worker: Worker) -> None:
    jobs = [asyncio.create_task(worker.call(time.sleep, 0.1)) for _ in range(1 + QUEUE_LENGTH)]
    await asyncio.sleep(0)

    with pytest.raises(WorkerBusyError) as raised:
        await worker.call(abs, -1)

    assert raised.value.retry_after_s > 0
    await asyncio.gather(*jobs)
    assert await worker.call(abs, -1) == 1


async def test_a_job_that_nobody_waits_for_any_more_gives_its_result_to_nobody_else(
    worker: Worker,
) -> None:
    await worker.call(os.getpid)
    job = asyncio.create_task(worker.call(time.sleep, 60))
    await asyncio.sleep(0.1)
    job.cancel()
    with pytest.raises(asyncio.CancelledError):
        await job

    assert await worker.call(abs, -1) == 1


async def test_the_process_ends_with_the_worker_and_a_closed_one_can_be_closed_again() -> None:
    worker = Worker()
    process = await worker.call(os.getpid)

    await worker.close()
    await worker.close()

    assert not is_there(process)


async def test_a_job_does_not_hold_up_the_end() -> None:
    worker = Worker()
    await worker.call(os.getpid)
    job = asyncio.create_task(worker.call(time.sleep, 60))
    await asyncio.sleep(0.1)

    await worker.close()

    with pytest.raises(WorkerClosedError):
        await job


@pytest.mark.parametrize("has_process", [True, False])
async def test_jobs_that_wait_at_the_end_fail_at_once_and_start_nothing(
    monkeypatch: pytest.MonkeyPatch, *, has_process: bool
) -> None:
    worker = Worker()
    if has_process:
        await worker.call(os.getpid)
    started = 0
    create = asyncio.create_subprocess_exec

    async def counted(*command: str, **options: Any) -> Process:  # noqa: ANN401
        nonlocal started
        started += 1
        return await create(*command, **options)

    monkeypatch.setattr(asyncio, "create_subprocess_exec", counted)
    jobs = [asyncio.create_task(worker.call(time.sleep, 60)) for _ in range(3)]
    await asyncio.sleep(0)

    async with asyncio.timeout(5):
        await worker.close()
        ends = await asyncio.gather(*jobs, return_exceptions=True)

    assert [type(end) for end in ends] == [WorkerClosedError] * 3
    assert started == (0 if has_process else 1)


async def test_a_closed_worker_takes_no_more_jobs(worker: Worker) -> None:
    await worker.close()

    with pytest.raises(WorkerClosedError):
        await worker.call(abs, -1)


async def test_the_process_ends_also_when_ours_is_killed() -> None:
    ours = await asyncio.create_subprocess_exec(sys.executable, "-c", HOLDER, stdout=PIPE)
    assert ours.stdout is not None
    worker = int(await ours.stdout.readline())
    assert is_there(worker)

    ours.kill()
    await ours.communicate()

    await asyncio.to_thread(wait_until_gone, worker)


async def test_the_process_ends_in_the_middle_of_a_job_when_ours_is_killed(tmp_path: Path) -> None:
    told = tmp_path / "pid"
    code = BUSY_HOLDER.format(path=str(told))
    ours = await asyncio.create_subprocess_exec(sys.executable, "-c", code)
    await until(lambda: told.exists() and told.read_text() != "", pause_s=0.02)
    worker = int(told.read_text())

    ours.kill()
    await ours.wait()

    await asyncio.to_thread(wait_until_gone, worker)


@pytest.mark.parametrize("limit_mb", [1_500, 800, 400])
async def test_jobs_are_done_where_the_environment_limits_memory(limit_mb: int) -> None:
    code = f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({limit_mb} << 20,) * 2)"
    ours = await asyncio.create_subprocess_exec(
        sys.executable, "-c", f"{code}\n{LIMITED}", stdout=PIPE
    )
    said, _ = await ours.communicate()

    assert said == b"1 MEMORY 2\n"


async def test_ctrl_c_in_the_terminal_does_not_reach_the_process(worker: Worker) -> None:
    # A terminal sends SIGINT to the processes of its session's foreground group.
    assert await worker.call(os.getsid, 0) != os.getsid(0)


async def test_the_robots_own_work_comes_first(worker: Worker) -> None:
    assert await worker.call(os.nice, 0) > os.nice(0)


def wait_until_gone(process: int) -> None:
    while is_there(process):
        time.sleep(0.01)


def is_there(process: int) -> bool:
    """Tell whether a process exists and is not just waiting to be noticed as dead."""
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            return file.read().rpartition(") ")[2][0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


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
