import pytest

from service.ros.graph.names import is_allowed


@pytest.mark.parametrize(
    "name", ["/arm", "/left/arm", "/_hidden", "/arm2/get_state", "/" + "a" * 224]
)
def test_names_of_ros_are_allowed(name: str) -> None:
    assert is_allowed(name)


@pytest.mark.parametrize(
    "name", ["arm", "/2arm", "/left arm", "/", "/arm/", "/ärm", "/" + "a" * 225]
)
def test_other_names_are_not(name: str) -> None:
    assert not is_allowed(name)
