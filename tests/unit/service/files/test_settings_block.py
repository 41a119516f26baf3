import pytest

from service.files.settings_block import bare_names


def test_names_are_those_of_ros_without_the_leading_slash() -> None:
    assert bare_names({"/battery": 1, "estop": 2}) == {"battery": 1, "estop": 2}


def test_a_name_that_occurs_with_and_without_a_slash_is_rejected() -> None:
    with pytest.raises(ValueError, match="battery is named twice"):
        bare_names({"/battery": 1, "battery": 2})
