"""Metrics: collected from a simulated robot in which each of them has a value."""

from typing import TypeAlias

from prometheus_client.metrics_core import Metric

from api.http.device_metrics import device_metrics
from api.http.schemas.simulation import SimulationBody
from api.robot_app import create_robot_app
from api.serving.closings import Closings, ClosingsCollector
from api.simulation.simulation import Simulation
from api.simulation.simulation_job import robot_for
from docs.generate.markdown import code, page, table
from docs.generate.source_scan import PROJECT, metric_names, require_described
from domain.computers import ComputerName, Connection
from service.worker import InlineJobs

_MODEL = PROJECT / "service" / "example" / "actuation.yaml"
_GOOD = {
    "battery_level": 0.9,
    "estop": False,
    "gps_accuracy": 100.0,
    "signal_strength": "CONNECTED",
    "temperature": 30.0,
}
_PATH = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(31)]
_Row: TypeAlias = tuple[str, str, str, str]


def metrics_page() -> str:
    """Return the page `metrics.md`.

    Raises:
        UndescribedError: A metric of the source was not collected.
    """
    families = _collected()
    require_described("metrics", metric_names(), {family.name for family in families})
    return page(
        "Metrics",
        "`GET /metrics`, in the Prometheus text format, computed on each request.",
        table(("name", "type", "label", "meaning"), (_row(family) for family in families)),
        "A gauge with a label has samples only for what exists: no active error, no sample.",
    )


def _collected() -> list[Metric]:
    """Return the metrics of a robot that drove, was stopped, and is changing to a mode."""
    steps = [
        {"t_s": 0, "reading": _GOOD},
        {"t_s": 1, "task": {"waypoints": _PATH}},
        {"t_s": 3, "node": "manipulator", "fault": "fail"},
        {"t_s": 3, "change": {"part": "actuation", "mode": "PERFORMANCE"}},
        {"t_s": 5, "reading": {"estop": True}},
    ]
    settings = {"signals": {"stale_after_s": 0}}
    body = SimulationBody.model_validate({"until_s": 6, "robot": settings, "steps": steps})
    robot = robot_for(body, _MODEL.read_text(encoding="utf-8"), None)
    Simulation(body, robot).run()
    app = create_robot_app(robot.supervisor, InlineJobs())
    # By the server in a live service.
    app.state.metrics.registry.register(ClosingsCollector(Closings()))
    arm = ComputerName("arm")
    connection = Connection(heard_at=0, round_trip=0, lost_share=0.0)
    of_devices = {each.name: each for each in device_metrics({arm: True}, {arm: connection}, 0)}
    return [
        # This robot has no other computer, and so no samples of them.
        of_devices.get(family.name, family)
        for family in app.state.metrics.registry.collect()
        if not family.name.endswith("_created")
    ]


def _row(family: Metric) -> _Row:
    # A counter is read as `..._total`, and a histogram has a sample for each of its buckets.
    name = f"{family.name}_total" if family.type == "counter" else family.name
    labels = sorted({label for sample in family.samples for label in sample.labels} - {"le"})
    return code(name), family.type, ", ".join(map(code, labels)), family.documentation
