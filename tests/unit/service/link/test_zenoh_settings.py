from typing import Any

import pytest

from domain.computers import SUPERVISOR, ComputerName
from domain.errors import InvalidValueError
from service.link.certificates import Certificates
from service.link.endpoints import Endpoints
from service.link.zenoh_settings import (
    BEAT,
    MESSAGE,
    access_control,
    at_any_port,
    check_endpoints,
    configuration,
    key,
    over_tls,
)

BASE, ARM = ComputerName("base"), ComputerName("arm")
FILES = Certificates("ca.pem", "base.pem", "base.key")
LOOPBACK, NETWORK = "127.0.0.1:7470", "10.0.0.1:7470"


def configured(listen: str, connect: str = "", files: Certificates | None = None) -> Any:  # noqa: ANN401  # JSON
    endpoints = Endpoints((listen,), (connect,) if connect else ())
    return configuration(BASE, [SUPERVISOR, ARM], endpoints, files)


def test_a_key_names_the_receiver_then_the_sender() -> None:
    assert key(SUPERVISOR, BASE, BEAT) == "pilothouse/supervisor/base/beat"
    assert key(BASE, SUPERVISOR, MESSAGE) == "pilothouse/base/supervisor/message"


def test_peers_look_for_each_other_only_where_they_are_told_to() -> None:
    made = configured("tcp/127.0.0.1:0", f"tcp/{LOOPBACK}")

    assert made["mode"] == "peer"
    assert made["listen"]["endpoints"] == ["tcp/127.0.0.1:0"]
    assert made["connect"]["endpoints"] == [f"tcp/{LOOPBACK}"]
    assert made["scouting"]["multicast"] == {"enabled": False}


def test_a_connection_is_tried_again_at_least_five_times_a_second() -> None:
    assert configured("tcp/127.0.0.1:0")["connect"]["retry"]["period_max_ms"] <= 200


@pytest.mark.parametrize(
    ("given", "made"),
    [
        (f"quic/{NETWORK}", f"quic/{NETWORK}?mixed_rel=auto"),
        (f"quic/{NETWORK}#iface=eth0", f"quic/{NETWORK}?mixed_rel=auto#iface=eth0"),
        (f"quic/{NETWORK}?rel=1", f"quic/{NETWORK}?rel=1"),
        (f"tls/{NETWORK}", f"tls/{NETWORK}"),
    ],
)
def test_quic_sends_datagrams_unless_the_endpoint_says_otherwise(given: str, made: str) -> None:
    assert configured(given, given, FILES)["listen"]["endpoints"][0] == made
    assert configured(given, given, FILES)["connect"]["endpoints"] == [made]


@pytest.mark.parametrize(
    ("endpoint", "detour"),
    [
        (f"quic/{NETWORK}", f"tls/{NETWORK}"),
        (f"quic/{NETWORK}?rel=1#iface=eth0", f"tls/{NETWORK}"),
        (f"tls/{NETWORK}", f"tls/{NETWORK}"),
        (f"tcp/{NETWORK}", f"tcp/{NETWORK}"),
    ],
)
def test_who_is_not_reached_over_quic_may_be_over_tls(endpoint: str, detour: str) -> None:
    assert over_tls(endpoint) == detour


def test_whoever_listens_at_a_port_of_quic_does_for_tls_as_well() -> None:
    at_a_port, anywhere = configured(f"quic/{NETWORK}"), configured("quic/10.0.0.1:0")

    assert at_a_port["listen"]["endpoints"] == [
        f"quic/{NETWORK}?mixed_rel=auto",
        f"tls/{NETWORK}#exit_on_failure=false",
    ]
    assert anywhere["listen"]["endpoints"] == ["quic/10.0.0.1:0?mixed_rel=auto"]


@pytest.mark.parametrize(
    ("endpoint", "elsewhere"),
    [
        ("tcp/127.0.0.1:7470", "tcp/127.0.0.1:0"),
        ("tls/[::1]:7470", "tls/[::1]:0"),
        ("quic/10.0.0.1:7470", "quic/10.0.0.1:0?mixed_rel=auto"),
    ],
)
def test_an_endpoint_may_be_tried_at_another_port(endpoint: str, elsewhere: str) -> None:
    assert at_any_port(endpoint) == elsewhere


def test_certificates_are_of_both_ends() -> None:
    tls = configured(f"quic/{NETWORK}", files=FILES)["transport"]["link"]["tls"]

    assert tls["enable_mtls"] is True
    assert (tls["listen_certificate"], tls["connect_certificate"]) == ("base.pem", "base.pem")
    assert (tls["listen_private_key"], tls["connect_private_key"]) == ("base.key", "base.key")
    assert tls["root_ca_certificate"] == "ca.pem"


def test_without_certificates_there_is_nothing_to_control_access_by() -> None:
    made = configured(f"tcp/{LOOPBACK}")

    assert "access_control" not in made
    assert "tls" not in made["transport"]["link"]


def test_a_computer_may_send_only_as_itself_and_only_to_us() -> None:
    made: Any = access_control(BASE, [SUPERVISOR, ARM])

    assert made["enabled"] is True
    assert made["default_permission"] == "deny"
    assert allowed(made, ARM, "ingress") == {
        ("put", "pilothouse/base/arm/*"),
        ("declare_subscriber", "pilothouse/arm/base/*"),
    }
    assert allowed(made, SUPERVISOR, "egress") == {
        ("put", "pilothouse/supervisor/base/*"),
        ("declare_subscriber", "pilothouse/base/supervisor/*"),
    }


def allowed(made: Any, name: ComputerName, flow: str) -> set[tuple[str, str]]:  # noqa: ANN401  # JSON
    """Return what the certificate of that name allows in one direction."""
    [subject] = [one["id"] for one in made["subjects"] if one["cert_common_names"] == [name]]
    ids = [id_ for one in made["policies"] if subject in one["subjects"] for id_ in one["rules"]]
    rules = [one for one in made["rules"] if one["id"] in ids and flow in one["flows"]]
    assert all(one["permission"] == "allow" for one in rules)
    return {(one["messages"][0], one["key_exprs"][0]) for one in rules}


@pytest.mark.parametrize(
    ("endpoint", "files", "insecure"),
    [
        (f"tcp/{LOOPBACK}", None, False),
        ("tcp/[::1]:7470", None, False),
        (f"tcp/{NETWORK}", None, True),
        (f"quic/{NETWORK}", FILES, False),
        (f"tls/{LOOPBACK}", FILES, False),
    ],
)
def test_an_endpoint_is_good_where_nobody_else_can_speak_or_that_is_allowed(
    endpoint: str, files: Certificates | None, insecure: bool
) -> None:
    check_endpoints(Endpoints((endpoint,), (endpoint,)), files, insecure=insecure)


@pytest.mark.parametrize(
    ("endpoint", "files", "insecure", "said"),
    [
        (f"tcp/{NETWORK}", None, False, "--insecure-link"),
        ("tcp/0.0.0.0:7470", None, False, "--insecure-link"),
        ("tcp/robot:7470", None, False, "--insecure-link"),
        (f"quic/{NETWORK}", None, True, "needs certificates"),
        (f"tls/{LOOPBACK}", None, False, "needs certificates"),
        (f"tcp/{NETWORK}", FILES, False, f"say quic/{NETWORK}"),
        (f"udp/{LOOPBACK}", FILES, True, f"say quic/{LOOPBACK}"),
    ],
)
def test_an_endpoint_where_others_could_speak_is_refused_with_what_to_do(
    endpoint: str, files: Certificates | None, insecure: bool, said: str
) -> None:
    good = f"quic/{LOOPBACK}" if files else f"tcp/{LOOPBACK}"
    for endpoints in (Endpoints((good, endpoint), ()), Endpoints((good,), (endpoint,))):
        with pytest.raises(InvalidValueError, match=said) as refused:
            check_endpoints(endpoints, files, insecure=insecure)
        assert endpoint in refused.value.message
