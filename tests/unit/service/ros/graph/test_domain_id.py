import pytest

from service.ros.graph.domain_id import check_domain


@pytest.mark.parametrize("text", ["", "0", "232", "0x10", " 7 "])
def test_a_domain_that_ros_knows_is_taken(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)

    check_domain()


@pytest.mark.parametrize("text", ["233", "-1", "home", "1.5"])
def test_a_domain_that_ros_would_misread_is_rejected(
    text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)

    with pytest.raises(RuntimeError, match="from 0 to 232"):
        check_domain()
