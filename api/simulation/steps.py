"""Performs the steps of a scenario on a robot in virtual time."""

import asyncio

from api.http.problems import problem_of
from api.http.routes.tasks import faults_in_body, task_request
from api.http.schemas.problem import Problem
from api.http.schemas.simulated import fault_of
from api.http.schemas.simulation import (
    AnyStep,
    ChangeStep,
    NodeStep,
    ReadingStep,
    RequestStep,
    TaskStep,
    VehicleStep,
)
from api.http.task_jobs import task_of
from api.simulation.requests import Requests
from domain.actor import Actor
from domain.errors import PilothouseError
from domain.health.signals import ESTOP_SIGNAL, asks_for_stop, signal_name
from domain.inputs import (
    CancelTaskRequest,
    ModeRequest,
    Reading,
    TransitionRequest,
)
from domain.lifecycle import Transition
from domain.state_and_mode import part_name
from domain.timebase import seconds
from service.simulation.virtual_time import VirtualService

_ACTOR = Actor("simulation")


class Actors:
    """The actors of a scenario: sensors, operators, faults."""

    def __init__(self, robot: VirtualService, runner: asyncio.Runner) -> None:
        self._robot = robot
        self._runner = runner
        self._requests: Requests | None = None

    def act(self, step: AnyStep) -> Problem | None:
        """Perform one step; return why it was rejected, or None."""
        try:
            match step:
                case RequestStep():
                    return self._send(step)
                case ReadingStep():
                    self._read(step)
                case TaskStep():
                    self._drive(step)
                case ChangeStep():
                    self._change(step)
                case NodeStep():
                    self._disturb(step)
                case VehicleStep():
                    self._robot.backend.set_vehicle_fault(fault_of(step.vehicle))
        except PilothouseError as error:
            return problem_of(error, self._robot.clock)
        return None

    def _read(self, step: ReadingStep) -> None:
        stamp = None
        if step.stamp_offset_s is not None:
            stamp = self._robot.clock.now() + seconds(step.stamp_offset_s)
        sent = [(signal_name(name), value) for name, value in step.reading.items()]
        readings = [Reading(signal, value, stamp) for signal, value in sent]
        take = self._robot.supervisor.readings.submit
        try:
            take(readings, step.source, _ACTOR)
        except PilothouseError:
            # As over HTTP, a stop is taken even if what came with it is rejected.
            if any(name == ESTOP_SIGNAL and asks_for_stop(value) for name, value in sent):
                take([Reading(ESTOP_SIGNAL, True, stamp)], step.source, _ACTOR)
            raise

    def _drive(self, step: TaskStep) -> None:
        if step.task is None:
            self._robot.supervisor.submit(CancelTaskRequest(_ACTOR))
        else:
            asked = task_request(task_of(step.task), _ACTOR)
            with faults_in_body():
                self._robot.supervisor.submit(asked)

    def _change(self, step: ChangeStep) -> None:
        asked, part = step.change, part_name(step.change.part)
        if asked.transition is None:
            request: ModeRequest | TransitionRequest = ModeRequest(part, asked.mode or "", _ACTOR)
        else:
            request = TransitionRequest(part, Transition(asked.transition), _ACTOR)
        self._robot.supervisor.submit(request)

    def _disturb(self, step: NodeStep) -> None:
        node = part_name(step.node)
        if step.parameters is None:
            self._robot.backend.set_fault(node, fault_of(step.fault))
        else:
            self._robot.backend.set_parameters(node, step.parameters)

    def _send(self, step: RequestStep) -> Problem | None:
        if self._requests is None:
            self._requests = Requests(self._robot.supervisor, self._runner)
        return self._requests.send(step.request)
