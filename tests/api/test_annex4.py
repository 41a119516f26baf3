"""The worked example of D4.8 (Annex 4, 6.2.2), step by step over HTTP."""

from tests.support.http_robot import HttpRobot

Shown = dict[str, tuple[str, str | None]]


async def actual(robot: HttpRobot) -> Shown:
    """Return state and mode of every part, as the mode monitor of D4.8 shows them."""
    parts = (await robot.get("/systems"))["items"] + (await robot.get("/nodes"))["items"]
    return {part["name"]: (part["actual"]["state"], part["actual"]["mode"]) for part in parts}


async def targets(robot: HttpRobot) -> Shown:
    """Return the target of every part."""
    parts = (await robot.get("/systems"))["items"] + (await robot.get("/nodes"))["items"]
    return {part["name"]: (part["target"]["state"], part["target"]["mode"]) for part in parts}


async def ask(robot: HttpRobot, path: str, **body: str) -> None:
    """Ask for a change and see it succeed."""
    answer = await robot.while_time_passes(5, robot.http.post(f"{path}?wait=5", json=body))
    assert answer.status_code == 200, answer.text


async def test_the_four_steps_of_annex_4(robot: HttpRobot) -> None:
    await ask(robot, "/systems/actuation/state", transition="configure")
    assert await actual(robot) == {
        "actuation": ("inactive", None),
        "drive_base": ("inactive", None),
        "manipulator": ("inactive", None),
    }

    await ask(robot, "/systems/actuation/state", transition="activate")
    assert await actual(robot) == {
        "actuation": ("active", "__DEFAULT__"),
        "drive_base": ("active", "__DEFAULT__"),
        "manipulator": ("inactive", None),
    }

    await ask(robot, "/systems/actuation/mode", mode="PERFORMANCE")
    assert await actual(robot) == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "FAST"),
        "manipulator": ("active", "STRONG"),
    }

    await ask(robot, "/nodes/drive_base/mode", mode="SLOW")
    await ask(robot, "/nodes/manipulator/mode", mode="WEAK")
    assert await actual(robot) == {
        "actuation": ("activating", "MODERATE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }
    assert await targets(robot) == {
        "actuation": ("active", "PERFORMANCE"),
        "drive_base": ("active", "SLOW"),
        "manipulator": ("active", "WEAK"),
    }


async def test_the_system_says_since_when_it_deviates_and_converges_when_asked_for_what_is(
    robot: HttpRobot,
) -> None:
    await ask(robot, "/systems/actuation/mode", mode="PERFORMANCE")
    await ask(robot, "/nodes/drive_base/mode", mode="SLOW")
    await ask(robot, "/nodes/manipulator/mode", mode="WEAK")

    deviating = await robot.get("/systems/actuation")
    assert (deviating["converged"], deviating["deviation_since_at"] is None) == (False, False)

    await ask(robot, "/systems/actuation/mode", mode="MODERATE")

    arrived = await robot.get("/systems/actuation")
    assert (arrived["converged"], arrived["deviation_since_at"]) == (True, None)
