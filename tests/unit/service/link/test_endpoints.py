"""One robot file serves each computer: who listens where follows from who it is."""

import pytest

from service.link.endpoints import (
    USUAL,
    Endpoints,
    is_on_this_machine,
    is_own_address,
    of_device,
    of_supervisor,
)

ROBOT = "quic/10.0.0.1:7470"


def here(listen: list[str], connect: list[str]) -> Endpoints:
    """Return the endpoints of the supervisor on the computer on which devices look for it."""
    return of_supervisor(listen, connect, [], lambda host: host == "10.0.0.1")


def test_without_a_word_all_computers_are_on_this_machine() -> None:
    assert of_supervisor([], [], []) == Endpoints((USUAL,), ())
    assert of_device([], [], []) == Endpoints(("tcp/127.0.0.1:0",), (USUAL,))


def test_devices_look_for_the_supervisor_where_the_file_says() -> None:
    listen, connect = ["quic/0.0.0.0:7470"], [ROBOT]

    assert here(listen, connect) == Endpoints(("quic/0.0.0.0:7470",), ())
    assert of_device(listen, connect, []) == Endpoints(("quic/0.0.0.0:0",), (ROBOT,))


def test_the_supervisor_listens_where_devices_look_for_it() -> None:
    assert here([], [ROBOT]) == Endpoints((ROBOT,), ())


def test_a_second_supervisor_goes_where_devices_look_for_the_first() -> None:
    own = ["tcp/127.0.0.1:9001"]

    assert of_supervisor([], [], own) == Endpoints(tuple(own), (USUAL,))
    # On another computer, with the same robot file.
    elsewhere = of_supervisor(["quic/0.0.0.0:7470"], [ROBOT], [], lambda host: False)
    assert elsewhere == Endpoints(("quic/0.0.0.0:7470",), (ROBOT,))


def test_this_machine_is_told_from_another_one() -> None:
    assert is_own_address("127.0.0.1")
    assert is_own_address("localhost")
    # Of the addresses that are for documentation only.
    assert not is_own_address("192.0.2.1")
    assert not is_own_address("no-such-host.invalid")


def test_devices_look_for_the_supervisor_where_it_listens() -> None:
    assert of_device([ROBOT], [], []).connect == (ROBOT,)


@pytest.mark.parametrize(
    ("listen", "found"),
    [
        ("tcp/0.0.0.0:9000", "tcp/127.0.0.1:9000"),
        ("tcp/[::]:9000", "tcp/[::1]:9000"),
    ],
)
def test_who_listens_everywhere_is_found_on_the_same_machine(listen: str, found: str) -> None:
    assert of_device([listen], [], []) == Endpoints(("tcp/127.0.0.1:0",), (found,))


def test_the_command_line_says_where_this_computer_listens() -> None:
    own = ["tcp/127.0.0.1:9001"]

    assert of_supervisor([ROBOT], [], own).listen == tuple(own)
    assert of_device([ROBOT], [], own) == Endpoints(tuple(own), (ROBOT,))


@pytest.mark.parametrize(
    ("endpoint", "is_here"),
    [
        ("tcp/127.0.0.1:7470", True),
        ("tcp/[::1]:7470", True),
        ("udp/localhost:7470", True),
        ("quic/127.0.0.1:7470?rel=0", True),
        ("tcp/10.0.0.1:7470", False),
        ("tcp/[fd00::1]:7470", False),
        ("tcp/supervisor:7470", False),
        ("tcp/0.0.0.0:7470", False),
    ],
)
def test_only_loopback_is_on_this_machine(endpoint: str, is_here: bool) -> None:
    assert is_on_this_machine([endpoint]) is is_here
