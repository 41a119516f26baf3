from api.serving.pieces import READ_COST, cost_of_bytes


def test_nothing_is_free() -> None:
    assert cost_of_bytes(0) == READ_COST
    assert cost_of_bytes(1_024) > cost_of_bytes(1)
