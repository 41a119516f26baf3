from dataclasses import asdict

from api.http.limits import ServiceLimits
from service.files.limits_block import LimitsBlock


def test_limits_of_which_nothing_is_said_are_as_usual() -> None:
    assert ServiceLimits.of(LimitsBlock()) == ServiceLimits()


def test_every_limit_that_is_said_holds() -> None:
    said = {
        "json_bytes": 2_000,
        "model_bytes": 3_000,
        "waypoints_bytes": 4_000,
        "message_bytes": 5_000,
        "stream_clients": 6,
        "requests_per_s": 7,
    }

    assert asdict(ServiceLimits.of(LimitsBlock.model_validate(said))) == said
