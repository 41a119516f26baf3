"""What routes are handed."""

from tests.support.http_robot import HttpRobot, http_scope


async def test_who_asks_is_recorded_by_address(robot: HttpRobot) -> None:
    await robot.http.put("/emergency_stop", json={"engaged": True})

    (event,) = [e for e in robot.supervisor.events.oldest_first() if "engaged" in e.kind]

    assert event.actor.label == "http:127.0.0.1"


async def test_who_asks_over_a_socket_without_addresses_is_unknown(robot: HttpRobot) -> None:
    scope = {**http_scope("PUT", "/emergency_stop"), "client": None}

    async def receive() -> dict[str, object]:
        return {"type": "http.request", "body": b'{"engaged": true}', "more_body": False}

    async def send(message: object) -> None:
        del message

    await robot.app(scope, receive, send)

    assert (await robot.get("/emergency_stop"))["by"] == "http:unknown"


async def test_the_part_in_a_path_is_looked_up_by_its_kind(robot: HttpRobot) -> None:
    assert (await robot.http.get("/nodes/drive_base")).status_code == 200
    assert (await robot.http.get("/systems/drive_base")).status_code == 404


async def test_parameters_of_a_system_lead_to_the_system_and_to_no_dead_end(
    robot: HttpRobot,
) -> None:
    hint = (await robot.http.get("/nodes/actuation/parameters")).json()["hint"]

    assert hint.endswith("see /systems/actuation")
    assert (await robot.http.get("/systems/actuation")).status_code == 200


async def test_a_hint_looks_up_few_prefixes_however_long_the_path_is(robot: HttpRobot) -> None:
    """Counted without any header: a page on the robot's network sends none that tells."""
    looked_up = 0

    class Counting(dict[str, object]):
        def __contains__(self, name: object) -> bool:
            nonlocal looked_up
            looked_up += 1
            return super().__contains__(name)

    model = robot.supervisor.model
    nodes = Counting({str(name): node for name, node in model.nodes.items()})
    object.__setattr__(model, "nodes", nodes)
    await robot.http.get("/nodes/" + "a/" * 4_000)

    assert looked_up < 300
