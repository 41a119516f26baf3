from service.sources.os.rates import Rate


def test_a_rate_needs_two_looks() -> None:
    times = iter([10.0, 12.0, 14.0])
    rate = Rate(lambda: next(times))

    assert [rate.per_second(counter) for counter in (100, 150, 150)] == [None, 25.0, 0.0]


def test_a_counter_that_began_anew_has_no_rate_until_the_next_look() -> None:
    times = iter([0.0, 1.0, 2.0])
    rate = Rate(lambda: next(times))

    assert [rate.per_second(counter) for counter in (100, 5, 8)] == [None, None, 3.0]


def test_two_looks_at_one_moment_give_no_rate() -> None:
    rate = Rate(lambda: 1.0)

    assert [rate.per_second(counter) for counter in (1, 2)] == [None, None]
