import os
from pathlib import Path

from api.serving.output import Output


def test_what_is_written_arrives_in_order() -> None:
    reader, writer = os.pipe()
    output = Output(writer)
    for number in range(100):
        output.write(f"{number}\n")
    output.close()
    os.close(writer)

    with open(reader) as pipe:
        assert pipe.read().split() == [str(number) for number in range(100)]


def test_a_pipe_that_nobody_reads_holds_up_nobody_and_the_loss_is_told() -> None:
    reader, writer = os.pipe()
    output = Output(writer, max_waiting=10)
    for _ in range(50):
        output.write("x" * 65_536)

    with open(reader, encoding="utf-8") as pipe:
        # What waits and what is being written is read; the rest was lost.
        assert pipe.read(65_536 * 10) == "x" * 65_536 * 10
        output.write("back\n")
        output.close()
        os.close(writer)
        rest = pipe.read()
    assert "texts were lost: nobody read this output\nback\n" in rest


def test_a_full_disk_and_a_closed_file_raise_nothing() -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        output = Output(full.fileno())
        output.write("lost\n")
        output.close()
    output = Output(999)
    output.write("lost\n")
    output.close()


def test_half_a_surrogate_pair_is_written_as_its_number() -> None:
    reader, writer = os.pipe()
    output = Output(writer)
    output.write("\ud800\n")
    output.close()
    os.close(writer)

    with open(reader, encoding="utf-8") as pipe:
        assert pipe.read() == "\\ud800\n"
