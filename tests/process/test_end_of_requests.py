"""What those who are being served are told when the process ends."""

import asyncio
import json
import signal
from urllib.parse import urlsplit

import httpx

from tests.support.process import ServiceProcess, service
from tests.support.waiting import until

LONG = {"until_s": 86_400, "sample_period_s": 86_400, "robot": {"mock": True}}


def problem_in(answer: bytes) -> dict[str, object]:
    """Return the problem of an answer in one piece."""
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 503"), head
    problem: dict[str, object] = json.loads(body)
    return problem


async def end(running: ServiceProcess) -> None:
    """End the process, in order and without a traceback."""
    running.send_signal(signal.SIGTERM)
    code, seconds, errors = await asyncio.to_thread(running.ended)
    assert code == 0
    assert seconds < 4
    assert "Traceback" not in errors


async def test_whoever_simulates_is_told_that_the_service_ends() -> None:
    with service() as running:
        async with httpx.AsyncClient(base_url=running.url, timeout=60) as http:
            asked = [asyncio.create_task(http.post("/simulations", json=LONG)) for _ in range(3)]
            await asyncio.sleep(1.5)
            await end(running)
            answers = await asyncio.gather(*asked)

    assert {(answer.status_code, answer.json()["code"]) for answer in answers} == {(503, "ENDING")}


async def test_whoever_is_still_sending_is_told_that_the_service_ends() -> None:
    with service() as running:
        address = urlsplit(running.url)
        reader, writer = await asyncio.open_connection(address.hostname, address.port)
        writer.write(b"POST /signals HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\n{")
        await asyncio.sleep(0.3)
        await end(running)
        answer = await reader.read()
        writer.close()

    assert problem_in(answer)["code"] == "ENDING"


async def test_a_simulation_ends_with_a_service_that_is_killed() -> None:
    with service() as running:
        async with httpx.AsyncClient(base_url=running.url, timeout=60) as http:
            asked = asyncio.create_task(http.post("/simulations", json=LONG))

            def children() -> list[int]:
                with open(f"/proc/{running.pid}/task/{running.pid}/children") as file:
                    return [int(pid) for pid in file.read().split()]

            await until(lambda: bool(children()), pause_s=0.05)
            await asyncio.sleep(1.0)
            (worker,) = children()
            running.send_signal(signal.SIGKILL)
            await asyncio.gather(asked, return_exceptions=True)

    def is_gone() -> bool:
        try:
            with open(f"/proc/{worker}/stat") as file:
                return file.read().rpartition(")")[2].split()[0] == "Z"
        except FileNotFoundError:
            return True

    await until(is_gone, pause_s=0.02)
