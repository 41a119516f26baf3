"""The other side of the worker, without a process."""

import io
import pickle

import pytest

from domain.errors import BlockedError, InvalidValueError
from domain.findings import Blocker
from domain.paths.path import Path
from service.worker_process import (
    MEMORY_LIMIT_BYTES,
    ErrorParcel,
    Reply,
    do,
    large,
    memory_limit,
    pack,
    read,
    serve,
)
from tests.support.paths import straight


def refuse() -> None:
    raise InvalidValueError("too fast", "speed")


def run_out_of_memory() -> None:
    raise MemoryError


def load_a_library(why_not: str) -> None:
    raise ImportError(why_not)


def sent(message: object) -> bytes:
    return b"".join(pack(message))


def replies_to(jobs: bytes) -> list[object]:
    replies = io.BytesIO()
    serve(io.BytesIO(jobs), replies)
    replies.seek(0)
    found = []
    while (reply := read(replies)) is not None:
        found.append(reply)
    return found


def test_jobs_are_done_in_order_until_there_are_no_more() -> None:
    assert replies_to(sent((abs, (-1,))) + sent((max, (1, 2)))) == [
        Reply("done", 1),
        Reply("done", 2),
    ]


def test_a_message_that_breaks_off_is_the_end() -> None:
    assert replies_to(sent((abs, (-1,))) + b"\x00\x00") == [Reply("done", 1)]


def test_a_body_is_sent_beside_the_pickle_and_arrives_as_it_was() -> None:
    body = bytes(range(256)) * 1_000
    pieces = pack((len, (large(body),)))

    assert [len(piece) for piece in pieces[2:]] == [len(body)]
    assert len(pieces[1]) < 200
    assert replies_to(b"".join(pieces)) == [Reply("done", len(body))]


def test_what_is_answered_in_bytes_arrives_as_bytes() -> None:
    assert replies_to(sent((bytes, (3,)))) == [Reply("done", b"\x00\x00\x00")]


def test_a_path_that_was_sent_is_the_same_path() -> None:
    (reply,) = replies_to(sent((straight, (20.0,))))

    assert isinstance(reply, Reply)
    assert isinstance(reply.value, Path)
    assert reply.value.length_m == 20.0
    assert reply.value.point_at(7.5).x_m == 7.5


def test_a_refusal_and_a_fault_are_told_apart() -> None:
    assert do((refuse, ())).outcome == "refused"
    assert do((abs, ("x",))).outcome == "failed"


def test_a_process_without_memory_does_not_go_on() -> None:
    with pytest.raises(MemoryError):
        do((run_out_of_memory, ()))


def test_nor_does_one_without_memory_for_a_library_that_a_job_is_the_first_to_use() -> None:
    with pytest.raises(ImportError):
        do((load_a_library, ("libblas.so: failed to map segment from shared object",)))

    assert do((load_a_library, ("No module named 'blas'",))).outcome == "failed"


def test_an_error_arrives_with_its_facts() -> None:
    blocker = Blocker("ESTOP", "stopped", ("actuation",))
    parcel: ErrorParcel = pickle.loads(
        pickle.dumps(ErrorParcel.of(BlockedError("actuation", [blocker])))
    )

    error = parcel.unpacked()

    assert isinstance(error, BlockedError)
    assert error.blockers == (blocker,)
    assert str(error) == "actuation cannot be changed: stopped"


@pytest.mark.parametrize(
    ("soft", "hard", "limit"),
    [
        (-1, -1, 100 + MEMORY_LIMIT_BYTES),
        (1 << 30, -1, 1 << 30),
        (-1, 1 << 30, 1 << 30),
        (1 << 29, 1 << 30, 1 << 29),
        (1 << 40, 1 << 40, 100 + MEMORY_LIMIT_BYTES),
    ],
)
def test_a_job_may_take_memory_beyond_what_is_used_but_no_more_than_the_environment_allows(
    soft: int, hard: int, limit: int
) -> None:
    assert memory_limit(100, soft, hard, infinity=-1) == limit
