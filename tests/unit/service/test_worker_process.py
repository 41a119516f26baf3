"""The other side of the worker, without a process."""

import io
import pickle

import pytest

from domain.errors import BlockedError, InvalidValueError
from domain.findings import Blocker
from service.worker_process import LENGTH_BYTES, ErrorParcel, Reply, do, length_of, pack, serve


def refuse() -> None:
    raise InvalidValueError("too fast", "speed")


def run_out_of_memory() -> None:
    raise MemoryError


def replies_to(sent: bytes) -> list[Reply]:
    jobs, replies = io.BytesIO(sent), io.BytesIO()
    serve(jobs, replies)
    replies.seek(0)
    found = []
    while head := replies.read(LENGTH_BYTES):
        found.append(pickle.loads(replies.read(length_of(head))))
    return found


def test_jobs_are_done_in_order_until_there_are_no_more() -> None:
    assert replies_to(pack((abs, (-1,))) + pack((max, (1, 2)))) == [
        Reply("done", 1),
        Reply("done", 2),
    ]


def test_a_message_that_breaks_off_is_the_end() -> None:
    assert replies_to(pack((abs, (-1,))) + b"\x00\x00") == [Reply("done", 1)]


def test_a_refusal_and_a_fault_are_told_apart() -> None:
    assert do(pickle.dumps((refuse, ()))).outcome == "refused"
    assert do(pickle.dumps((abs, ("x",)))).outcome == "failed"


def test_a_process_without_memory_does_not_go_on() -> None:
    with pytest.raises(MemoryError):
        do(pickle.dumps((run_out_of_memory, ())))


def test_an_error_arrives_with_its_facts() -> None:
    blocker = Blocker("ESTOP", "stopped", ("actuation",))
    parcel: ErrorParcel = pickle.loads(
        pickle.dumps(ErrorParcel.of(BlockedError("actuation", [blocker])))
    )

    error = parcel.unpacked()

    assert isinstance(error, BlockedError)
    assert error.blockers == (blocker,)
    assert str(error) == "actuation cannot be changed: stopped"
