import pytest
from pydantic import ValidationError

from domain.timebase import seconds
from service.files.link_block import LinkBlock


def fault(**keys: object) -> str:
    with pytest.raises(ValidationError) as caught:
        LinkBlock.model_validate(keys)
    (found,) = caught.value.errors()
    return f"{'.'.join(map(str, found['loc']))}: {found['msg']}"


def test_by_default_a_computer_is_late_after_half_a_second_and_lost_a_second_later() -> None:
    link = LinkBlock()

    assert (link.late, link.lost) == (seconds(0.5), seconds(1.5))
    assert (link.listen, link.connect) == ([], [])


def test_endpoints_and_files_are_read() -> None:
    link = LinkBlock.model_validate(
        {
            "listen": ["quic/0.0.0.0:7447"],
            "connect": ["quic/[fe80::1]:7447", "tls/robot.local:7447"],
            "ca": "/etc/pilothouse/ca.pem",
            "certificate": "/etc/pilothouse/{name}.pem",
            "key": "/etc/pilothouse/{name}.key",
        }
    )

    assert link.connect == ["quic/[fe80::1]:7447", "tls/robot.local:7447"]
    assert link.certificate == "/etc/pilothouse/{name}.pem"


@pytest.mark.parametrize(
    "endpoint", ["", "7447", "http/10.0.0.1:80", "tcp/", "tcp/a b:1", "quic/" + "a" * 241]
)
def test_what_is_no_endpoint_is_refused_where_it_stands(endpoint: str) -> None:
    assert fault(listen=[endpoint]).startswith("listen.0: ")


@pytest.mark.parametrize(
    ("key", "wrong"),
    [("late_s", 0.1), ("late_s", 11.0), ("lost_s", 0.4), ("lost_s", 61.0)],
)
def test_times_beyond_their_bounds_are_refused(key: str, wrong: float) -> None:
    assert fault(**{key: wrong}).startswith(f"{key}: ")


def test_a_computer_is_late_before_it_is_lost() -> None:
    assert "late_s must be less than lost_s" in fault(late_s=2.0)


@pytest.mark.parametrize("given", [("ca",), ("certificate", "key"), ("ca", "key")])
def test_a_certificate_needs_all_of_its_files(given: tuple[str, ...]) -> None:
    assert "go together" in fault(**dict.fromkeys(given, "file.pem"))
