import pytest

from domain.state_and_mode import StateAndMode, part_name


@pytest.mark.parametrize(
    ("text", "label"),
    [
        ("active", "active"),
        ("active.FAST", "active.FAST"),
        ("active.A.B", "active.A.B"),
        ("activating.FAST", "activating.FAST"),
        ("inactive.FAST", "inactive"),
    ],
)
def test_state_and_mode_are_read_and_written_as_one_word(text: str, label: str) -> None:
    assert StateAndMode.parse(text).label == label


@pytest.mark.parametrize("text", ["", "ACTIVE", "banana", ".FAST"])
def test_a_word_that_is_no_state_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="not a valid LifecycleState"):
        StateAndMode.parse(text)


@pytest.mark.parametrize(
    ("one", "other", "agree"),
    [
        ("active", "active.__DEFAULT__", True),
        ("active", "active.FAST", False),
        ("active.FAST", "active.FAST", True),
        ("active", "inactive", False),
        ("activating.A", "activating.B", True),
    ],
)
def test_no_mode_and_the_default_mode_mean_the_same(one: str, other: str, agree: bool) -> None:
    pair = StateAndMode.parse(one), StateAndMode.parse(other)

    assert pair[0].agrees_with(pair[1]) is agree
    assert pair[1].agrees_with(pair[0]) is agree


def test_a_name_as_ros_2_writes_it_has_slashes_before_it() -> None:
    assert part_name("/left/arm") == part_name("left/arm") == "left/arm"


def test_only_slashes_are_taken_from_a_name() -> None:
    assert part_name("/X/arm") == "X/arm"
