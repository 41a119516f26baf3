from api.robot_app import create_robot_app
from service.worker import InlineJobs
from tests.support.live_robot import make_supervisor


def test_the_interface_of_one_robot_has_no_simulations_in_it() -> None:
    app = create_robot_app(make_supervisor(), InlineJobs())
    paths = app.openapi()["paths"]

    assert "/tasks" in paths
    assert "/simulations" not in paths
