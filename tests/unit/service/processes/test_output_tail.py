"""The last lines of what a program prints."""

from hypothesis import given
from hypothesis import strategies as st

from service.processes.output_tail import MAX_LINE_BYTES, MAX_LINES, OutputTail


def tail_of(*pieces: bytes) -> list[str]:
    tail = OutputTail()
    for piece in pieces:
        tail.add(piece)
    return tail.lines()


def test_lines_are_kept_as_they_were_printed() -> None:
    assert tail_of(b"one\ntw", b"o\n", b"\nfour") == ["one", "two", "", "four"]


def test_only_the_last_lines_are_kept() -> None:
    lines = tail_of(*(f"{number}\n".encode() for number in range(1_000)))

    assert lines == [str(number) for number in range(1_000 - MAX_LINES, 1_000)]


def test_a_line_that_never_ends_takes_no_memory() -> None:
    (line,) = tail_of(*[b"x" * 10_000] * 100)

    assert line == "x" * MAX_LINE_BYTES + " ..."


def test_what_is_no_text_does_no_harm() -> None:
    assert tail_of(b"\xff\xfe\r\n") == ["\ufffd\ufffd"]


@given(st.lists(st.binary(max_size=5_000), max_size=20), st.binary(max_size=600))
def test_how_the_output_was_cut_makes_no_difference(pieces: list[bytes], more: bytes) -> None:
    pieces += [more.replace(b"\x00", b"\n")] * 3

    assert tail_of(*pieces) == tail_of(b"".join(pieces))
    assert len(tail_of(*pieces)) <= MAX_LINES
