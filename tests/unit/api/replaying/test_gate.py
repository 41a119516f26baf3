from api.http.route_policy import policy_of
from api.http.route_table import each_route, methods_of
from tests.support.viewer import Viewer


async def test_every_request_that_would_change_a_robot_is_rejected(viewer: Viewer) -> None:
    tried = set()
    for route in each_route(viewer.app.routes):
        declared = policy_of(route.endpoint)
        assert declared is not None
        for method in methods_of(route) if declared.permission.writes else ():
            path = route.path.replace("{", "").replace("}", "").replace(":path", "")
            answer = await viewer.http.request(method, path, content=b"{}")
            assert (answer.status_code, answer.json()["code"]) == (409, "RECORDING"), path
            tried.add(path)

    assert {"/emergency_stop", "/tasks", "/signals", "/holds/owner", "/mock/signal"} <= tried
