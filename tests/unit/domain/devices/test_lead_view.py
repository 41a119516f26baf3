from domain.devices.lead_view import Word


def test_clients_are_told_whose_word_counts_in_one_word() -> None:
    assert [*Word] == ["nobody", "supervisor", "cut_off", "device"]
