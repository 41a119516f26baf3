"""`/analysis`: what leads to the errors that stop the task."""

from tests.support.http_robot import HttpRobot


async def test_each_error_that_stops_the_task_has_its_cut_sets(robot: HttpRobot) -> None:
    errors = (await robot.get("/analysis"))["errors"]

    assert {
        "part": None,
        "error": "ESTOP",
        "severity": "critical",
        "cut_sets": [[{"part": None, "error": "ESTOP"}]],
        "incomplete": None,
    } in errors
    assert len(errors) == 7
