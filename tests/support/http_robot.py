"""The example robot behind its HTTP interface, in virtual time and without a network."""

import asyncio
from collections.abc import AsyncIterator, Coroutine, Mapping, Sequence
from contextlib import asynccontextmanager
from functools import cache
from typing import Any, TypeVar

import httpx

from api.app import close_workers, create_app
from api.http.access import Access
from api.http.gate.policies import RoutePolicies
from api.http.limits import USUAL_LIMITS, ServiceLimits
from api.simulation.simulation_job import SimulatedParts
from domain.commands import Drive, NodeCommand
from domain.findings import Finding
from domain.simulation.node_settings import Fault, NodeSettings
from domain.simulation.robot import SimulatedRobot
from domain.simulation.vehicle_settings import VehicleSettings
from domain.state_and_mode import PartName
from domain.supervision import SupervisionSettings
from service.files.model_file import LoadedModel, read_model
from service.keeper import Stores
from service.simulation.simulated import SimulatedBackend
from service.storage.trends.trends import Trends
from service.supervisor import Supervisor
from tests.support.live_robot import make_onboard, make_supervisor, running
from tests.support.manual_clock import ManualClock, settle

ACTUATION = """\
actuation:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {drive_base: active, manipulator: inactive}
      MODERATE: {drive_base: active.SLOW, manipulator: active.WEAK}
      PERFORMANCE: {drive_base: active.FAST, manipulator: active.STRONG}
drive_base:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_speed: 0.1, controller: PID}}
      SLOW: {ros__parameters: {max_speed: 0.2, controller: PID}}
      FAST: {ros__parameters: {max_speed: 0.9, controller: MPC}}
manipulator:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {max_torque: 0.1}}
      WEAK: {ros__parameters: {max_torque: 0.15}}
      STRONG: {ros__parameters: {max_torque: 0.2}}
"""
"""The robot of D4.8, Annex 4, with a torque of its own for WEAK."""

Answer = TypeVar("Answer")


class _Backend(SimulatedBackend):
    """Remembers what it is sent."""

    def __init__(self, robot: SimulatedRobot, clock: ManualClock) -> None:
        super().__init__(robot, clock)
        self.sent: list[NodeCommand | Drive] = []

    def send(self, command: NodeCommand | Drive, /) -> None:
        self.sent.append(command)
        super().send(command)


class HttpRobot:
    """One robot: its interface (`http`), its clock, and what can be done to its nodes."""

    def __init__(
        self,
        text: str = ACTUATION,
        *,
        mock: bool = True,
        settings: SupervisionSettings | None = None,
        nodes: Mapping[str, NodeSettings] | None = None,
        vehicle: VehicleSettings | None = None,
        warnings: Sequence[Finding] = (),
        access: Access | None = None,
        limits: ServiceLimits = USUAL_LIMITS,
    ) -> None:
        self.clock = ManualClock()
        model = read_model(text).model
        by_name = {PartName(name): setting for name, setting in (nodes or {}).items()}
        robot = SimulatedRobot(model, 0, by_name, vehicle, mock=mock)
        self.backend = _Backend(robot, self.clock)
        onboard = make_onboard(model, 0, settings)
        self.simulated = SimulatedParts(onboard, robot)
        self.supervisor = Supervisor(
            LoadedModel(model, tuple(warnings), text),
            onboard,
            self.clock,
            self.backend,
            self.backend.readings,
            simulated=robot.what,
            stores=Stores(trends=Trends((settings or SupervisionSettings()).signals)),
        )
        self.supervisor.live_faults = self.backend
        self.app = create_app(
            self.supervisor,
            allowed_hosts=["robot"],
            access=access,
            limits=limits,
            simulated=self.simulated,
        )
        transport = httpx.ASGITransport(self.app)
        self.http = httpx.AsyncClient(transport=transport, base_url="http://robot:8000")

    @property
    def sent(self) -> list[NodeCommand | Drive]:
        """Return what was sent to nodes and vehicle so far."""
        return self.backend.sent

    async def pass_time(self, by_s: float) -> None:
        """Let virtual time pass."""
        await self.clock.advance(by_s)

    async def while_time_passes(self, by_s: float, asked: Coroutine[Any, Any, Answer]) -> Answer:
        """Return the answer to a request that waits for the robot, `by_s` seconds later at most."""
        task = asyncio.create_task(asked)
        await settle()
        await self.clock.advance(by_s)
        return await task

    async def get(self, path: str) -> Any:  # noqa: ANN401
        """Return what a successful GET answers."""
        answer = await self.http.get(path)
        assert answer.status_code == httpx.codes.OK, answer.text
        return answer.json()

    async def bring_to(self, part: str, mode: str) -> None:
        """Bring a part into a mode and let it arrive."""
        kind = "systems" if part in self.supervisor.model.systems else "nodes"
        answer = await self.http.post(f"/{kind}/{part}/mode", json={"mode": mode})
        assert answer.status_code == httpx.codes.ACCEPTED, answer.text
        await self.pass_time(3)
        assert (await self.get(answer.headers["location"]))["status"] == "succeeded"

    def break_node(self, node: str, fault: Fault | None) -> None:
        """Give a node a fault; None: it has none any more."""
        self.backend.set_fault(PartName(node), fault)


@asynccontextmanager
async def http_robot(text: str = ACTUATION, **options: Any) -> AsyncIterator[HttpRobot]:  # noqa: ANN401
    """Let a robot run as long as the context lasts, with the options of `HttpRobot`."""
    robot = HttpRobot(text, **options)
    async with running(robot.supervisor), robot.http:
        yield robot
    await close_workers(robot.app)
    if robot.supervisor.trends is not None:
        await robot.supervisor.trends.close()


def http_scope(method: str, path: str, query: str = "", **headers: str) -> dict[str, Any]:
    """Return the ASGI scope of a request, for tests that are the server themselves."""
    named = {"host": "robot", **headers}
    return {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": method,
        "scheme": "http",
        "path": path,
        "raw_path": path.encode(),
        "root_path": "",
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in named.items()],
        "client": ("10.0.0.1", 50_000),
        "server": ("robot", 80),
    }


@cache
def declared_policies() -> RoutePolicies:
    """Return what the routes of the service declare, for tests of a gate alone."""
    return RoutePolicies(create_app(make_supervisor(), allowed_hosts=[]).routes)
