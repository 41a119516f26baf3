from domain.computers import SUPERVISOR, ComputerName, computer_words


def test_a_computer_is_called_what_it_is() -> None:
    assert computer_words(SUPERVISOR) == "the supervisor"
    assert computer_words(ComputerName("arm")) == "device arm"
