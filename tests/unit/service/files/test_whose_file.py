from domain.computers import SUPERVISOR, ComputerName
from service.files.robot_file import read_robot_file, written_out
from service.files.whose_file import computer_of, with_computer
from tests.support.models import actuation_model

ARM = ComputerName("arm")
TEXT = "name: lawn\nmock: false\n"


def test_the_log_of_a_device_says_which_one_it_is() -> None:
    assert computer_of(with_computer(TEXT, ARM)) == ARM


def test_the_log_of_the_supervisor_keeps_the_file_as_it_is() -> None:
    assert with_computer(TEXT, SUPERVISOR) == TEXT
    assert computer_of(TEXT) == computer_of("") == SUPERVISOR


def test_the_file_reads_the_same_with_it() -> None:
    kept = with_computer(written_out("include: [battery]\n" + TEXT), ARM)

    assert read_robot_file(kept, actuation_model()) == read_robot_file(
        written_out("include: [battery]\n" + TEXT), actuation_model()
    )
