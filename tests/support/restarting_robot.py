"""The core and a simulated robot of which only the service is restarted: the robot goes on."""

import pickle

from domain.inputs import Input, Restored
from domain.kept import Kept
from domain.outbox import Outputs
from domain.parts.system_model import SmhModel
from domain.simulation.vehicle_settings import VehicleSettings
from domain.supervision import SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.live_robot import make_onboard


class RestartingRobot(CoreRobot):
    """A robot whose service keeps what it is told to, dies, and is started again."""

    def __init__(
        self,
        model: SmhModel,
        settings: SupervisionSettings | None = None,
        vehicle: VehicleSettings | None = None,
    ) -> None:
        self.settings = settings
        self.kept: dict[tuple[type[Kept], str], Kept] = {}
        """What is on disk."""
        self.boot = 1
        self.tasks_served = 0
        super().__init__(model, settings, vehicle=vehicle)

    def give(self, given: Input) -> Outputs:
        """Hand one input to the core, and keep what it says."""
        outputs = super().give(given)
        for item in outputs.kept:
            if item.value is None:
                self.kept.pop((item.kind, item.name), None)
            else:
                self.kept[item.kind, item.name] = item.value
        self.tasks_served += outputs.task is not None
        return outputs

    def restart(self, down_s: float = 1.0, settings: SupervisionSettings | None = None) -> Outputs:
        """Kill the service; the robot does what it does without commands until it is back.

        Args:
            down_s: How long that takes.
            settings: What the robot file says now; None: what it said before.

        Returns:
            What the new service said first.
        """
        self.now += seconds(down_s)
        self.robot.advance(self.now)
        self.settings = settings or self.settings
        self.boot += 1
        kept: tuple[Kept, ...] = pickle.loads(pickle.dumps(tuple(self.kept.values())))
        self.onboard = make_onboard(self.model, self.now, self.settings)
        self.core = self.onboard.core
        self.commands.clear()
        self.events.clear()
        return self.give(Restored(kept, self.boot, 1, 1, self.tasks_served + 1))
