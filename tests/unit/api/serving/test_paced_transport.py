import asyncio

from api.serving.paced_transport import PacedTransport
from tests.support.flooded_wire import RawTransport


def test_all_but_pauses_and_the_protocol_is_passed_on() -> None:
    raw, asked = RawTransport(), list[str]()
    paced = PacedTransport(
        raw,
        lambda: asked.append("pause"),
        lambda: asked.append("resume"),
        lambda _: asked.append("succeed"),
    )

    paced.write(b"data")
    paced.pause_reading()
    paced.resume_reading()
    paced.abort()

    assert raw.written == b"data"
    assert paced.get_extra_info("peername")[0] == "192.0.2.1"
    assert asked == ["pause", "resume"]
    assert raw.reads
    assert paced.is_closing()


def test_once_it_has_ended_a_timer_that_keeps_it_keeps_nothing_else() -> None:
    asked = list[str]()
    paced = PacedTransport(
        RawTransport(),
        lambda: asked.append("pause"),
        lambda: asked.append("resume"),
        lambda _: asked.append("succeed"),
    )

    paced.part()
    paced.pause_reading()
    paced.resume_reading()
    paced.set_protocol(asyncio.Protocol())

    assert not asked
