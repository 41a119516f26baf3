import pytest
from pydantic import ValidationError

from service.files.limits_block import KIB, MIB, LimitsBlock

BOUNDS = {
    "json_bytes": (KIB, MIB),
    "model_bytes": (KIB, 16 * MIB),
    "waypoints_bytes": (KIB, 16 * MIB),
    "message_bytes": (KIB, MIB),
    "stream_clients": (1, 100_000),
    "requests_per_s": (1, 1_000_000),
}


def test_every_limit_has_bounds() -> None:
    assert set(BOUNDS) == set(LimitsBlock.model_fields)


@pytest.mark.parametrize("key", BOUNDS)
def test_a_limit_may_be_at_its_bounds(key: str) -> None:
    for value in BOUNDS[key]:
        assert getattr(LimitsBlock.model_validate({key: value}), key) == value


@pytest.mark.parametrize("key", BOUNDS)
def test_a_limit_beyond_its_bounds_is_refused_where_it_stands(key: str) -> None:
    least, most = BOUNDS[key]

    for wrong in (least - 1, most + 1, 2_000.5, "2000", True, None):
        with pytest.raises(ValidationError) as caught:
            LimitsBlock.model_validate({key: wrong})
        (fault,) = caught.value.errors()
        assert fault["loc"] == (key,)


def test_a_limit_that_there_is_not_is_refused() -> None:
    with pytest.raises(ValidationError, match="no_such_limit"):
        LimitsBlock.model_validate({"no_such_limit": 1})
