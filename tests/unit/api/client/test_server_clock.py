from api.client.server_clock import ServerClock


def test_before_the_first_frame_it_is_our_own() -> None:
    assert ServerClock().at(100.0) == 100.0


def test_of_several_frames_the_one_that_travelled_least_counts() -> None:
    clock = ServerClock()

    clock.observe(1000.0, 10.5)
    clock.observe(1001.0, 11.1)
    clock.observe(1002.0, 12.9)

    assert clock.at(13.0) == 1002.9


def test_when_either_clock_is_set_that_is_noticed_within_two_windows() -> None:
    clock = ServerClock()
    clock.observe(1000.0, 10.0)

    for local_s in (25.0, 40.0, 55.0):
        clock.observe(500.0 + local_s, local_s)

    assert clock.at(60.0) == 560.0
