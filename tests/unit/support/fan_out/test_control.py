import json

import pytest

from tests.support.fan_out.control import frame


@pytest.mark.parametrize("number", [1, 12_345])
def test_a_frame_has_exactly_the_size_that_is_asked_for(number: int) -> None:
    text = frame(number, 400)

    assert len(text.encode()) == 400
    assert json.loads(text)["seq"] == number
