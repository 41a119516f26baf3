from api.cli.unknown_name import no_such


def test_an_unknown_name_is_told_with_the_nearest() -> None:
    error = no_such("hold", "operater", ["operator", "loading"])

    assert error.problem["detail"] == "there is no hold 'operater'"
    assert error.problem["hint"] == "known: operator, loading; did you mean operator?"


def test_where_there_is_none_at_all_that_is_told() -> None:
    assert no_such("hold", "operator", []).problem["hint"] == "there is no hold at all"
