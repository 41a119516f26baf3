import pytest

from tests.support.scripted_robot import ScriptedRobot


@pytest.fixture
def robot() -> ScriptedRobot:
    """Return a robot that stands at the origin and is well."""
    return ScriptedRobot()
