"""The interface of a recorded robot: what can be read of a live one, and nothing to change it."""

from functools import partial

from fastapi import FastAPI

from api.documents import route as documents
from api.http.gate.ending import Ending
from api.http.gate.headers import SecurityHeaders
from api.http.gate.origin import OriginGate
from api.http.gate.policies import RoutePolicies
from api.http.gate.target import TargetGate
from api.replaying import route
from api.replaying.gate import RecordingGate
from api.replaying.player import Player
from api.robot_app import create_robot_app, show
from service.clock import Clock
from service.replayed_robot import ReplayedRobot
from service.worker import InlineJobs


def create_replay_app(player: Player, clock: Clock) -> FastAPI:
    """Return the application, for this machine only; somebody else lets the player run.

    Args:
        player: What is shown.
        clock: Of the connections; that of the recording goes at another speed.
    """
    jobs = InlineJobs()
    app = create_robot_app(player.robot.supervisor, jobs, clock=clock)
    state = app.state
    state.simulator = state.replayer = jobs
    state.player = player
    app.include_router(route.router)
    app.include_router(documents.router)
    player.on_robot = partial(_show, app, player, clock)
    state.stream_server.encoder.replay = partial(route.shown, player)
    policies, refusals = RoutePolicies(app.routes), state.refusals
    app.add_middleware(RecordingGate, policies=policies, clock=clock)
    app.add_middleware(OriginGate, allowed_hosts=(), refusals=refusals, policies=policies)
    app.add_middleware(TargetGate, refusals=refusals)
    app.add_middleware(SecurityHeaders)
    app.add_middleware(Ending)
    return app


def _show(app: FastAPI, player: Player, clock: Clock, robot: ReplayedRobot) -> None:
    """Show another robot; clients of the earlier one have to come again."""
    before = app.state.stream_server
    show(app, robot.supervisor, clock)
    app.state.stream_server.encoder.replay = partial(route.shown, player)
    before.fan_out.disconnect_all()
