"""Pages of the reference that follow from the code are what the code says."""

import re
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml
from packaging.version import Version

from api.cli.command_line import main
from api.http.problems import STATUS_OF
from api.http.schemas.simulation import SimulationBody
from api.simulation.simulation import Simulation
from api.simulation.simulation_job import robot_for
from docs.generate.__main__ import main as renew
from docs.generate.pages import FOLDER, PAGES
from docs.generate.source_scan import UndescribedError, codes_given_to, require_described
from domain.actor import Actor
from domain.changes.admission import ADVISORY
from domain.computers import ComputerName, DeviceState, PeerStop, StopId
from domain.conditions.condition import Condition
from domain.controller import NavigationStatus
from domain.events.event import RecordedEvent
from domain.events.kinds import EVENTS
from domain.graph_terms import GraphFault, GraphFaultKind
from domain.health.checkpoints import CheckpointSettings
from domain.health.signals import (
    Bound,
    Comparison,
    ModeLimit,
    SignalKind,
    SignalSettings,
    SignalSpec,
    default_signals,
)
from domain.inputs import (
    BackendStatus,
    CheckpointReport,
    DriveStatus,
    EmergencyStopRequest,
    ErrorReport,
    Input,
    ModeRequest,
    NodeReport,
    PeerStops,
    Restored,
    ServiceStall,
    ShelveRequest,
    SourceFault,
    StorageStatus,
    TimePassed,
    UnshelveRequest,
    WriteRecord,
)
from domain.kept import KeptHold, KeptTarget
from domain.lifecycle import LifecycleState
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import Rule
from domain.process_terms import ProcessAction, ProcessExit, ProcessReport, ProcessRequest
from domain.processes.settings import ProcessSettings
from domain.snapshot import ErrorKey
from domain.state_and_mode import ModeName, PartName, StateAndMode
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import seconds
from tests.support.core_robot import CoreRobot
from tests.support.device_robot import DeviceRobot, offline
from tests.support.following_robot import FollowingRobot
from tests.support.good import GOOD
from tests.support.guarded_model import guarded_model
from tests.support.http_robot import ACTUATION
from tests.support.models import ARM, BASE, active, actuation_model
from tests.support.reacting_robot import REST, ReactingRobot
from tests.support.robot_of_devices import RobotOfDevices
from tests.support.ruled_robot import RuledRobot, degrading_model
from tests.support.shared import PROJECT

STRAIGHT = [{"x_m": float(x), "y_m": 0.0, "yaw_rad": 0.0} for x in range(31)]
# Nothing follows from feedback, so that it is not recorded.
NEVER_SEEN_HERE = {"goal.feedback"}
# They have parameters, from which their mode is inferred.
NOT_BY_SIMULATED_NODES = {"mode"}


LOCK = PROJECT / "requirements.lock"


def is_older_than_locked(package: str) -> bool:
    locked = re.search(rf"^{package}==(\S+)", LOCK.read_text(encoding="utf-8"), re.MULTILINE)
    assert locked is not None
    return Version(version(package)) < Version(locked[1])


IS_OLDER = is_older_than_locked("fastapi") or is_older_than_locked("pydantic")


@pytest.mark.parametrize("name", sorted(PAGES))
def test_a_page_is_what_the_code_says(name: str) -> None:
    if IS_OLDER and name.endswith(".json"):
        pytest.skip("an older framework words its part of the documents otherwise")
    checked_in = (FOLDER / name).read_text(encoding="utf-8")

    # Without line breaks: argparse of another Python breaks its lines elsewhere.
    assert checked_in.split() == PAGES[name]().split(), "run `python -m docs.generate`"


def test_only_what_differs_is_written_anew(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("docs.generate.__main__.PAGES", {"a.md": lambda: "A", "b.md": lambda: "B"})
    (tmp_path / "a.md").write_text("A", encoding="utf-8")
    renew(tmp_path)

    assert capsys.readouterr().out == "renewed b.md\n"
    assert (tmp_path / "b.md").read_text(encoding="utf-8") == "B"


def test_every_command_has_its_help_on_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    page = (FOLDER / "command-line.md").read_text(encoding="utf-8")
    with pytest.raises(SystemExit):
        main(["--help"])
    named = re.findall(r"^    ([a-z]+) +\S", capsys.readouterr().out, flags=re.MULTILINE)

    assert {"serve", "stop", "completion"} <= set(named)
    assert [name for name in named if f"usage: pilothouse {name} " not in page] == []


def test_every_code_of_an_error_is_on_the_page_of_problems() -> None:
    page = (FOLDER / "problems.md").read_text(encoding="utf-8")

    assert [error.code for error in STATUS_OF if f"| `{error.code}` |" not in page] == []


def test_every_blocker_is_on_its_page() -> None:
    page = (FOLDER / "blockers.md").read_text(encoding="utf-8")

    assert [code for code in ADVISORY if f"| `{code}` | no |" not in page] == []


def test_what_nobody_described_is_told_by_name() -> None:
    with pytest.raises(UndescribedError, match=r"events: describe \['a\.b'\], remove \['c\.d'\]"):
        require_described("events", {"a.b", "x.y"}, {"c.d", "x.y"})


def test_codes_are_found_as_arguments_and_as_constants() -> None:
    assert {"HOST_NOT_ALLOWED", "NO_MOCK"} <= codes_given_to("make_problem", "HttpError")


# --- events --------------------------------------------------------------------------------------


def happened(
    *steps: dict[str, object], until_s: float = 20, **robot: object
) -> list[RecordedEvent]:
    """Return the events of a scenario of the robot of Annex 4."""
    settings = {"signals": {"stale_after_s": 0}, **robot}
    first = {"t_s": 0, "reading": dict(GOOD)}
    body = SimulationBody.model_validate(
        {"until_s": until_s, "robot": settings, "steps": [first, *steps]}
    )
    simulation = Simulation(body, robot_for(body, ACTUATION, None))
    simulation.run()
    assert [refusal.problem.detail for refusal in simulation.unexpected_refusals()] == []
    return list(simulation.events)


def request(t_s: float, method: str, path: str, **body: object) -> dict[str, object]:
    return {"t_s": t_s, "request": {"method": method, "path": path, "body": body or None}}


def a_drive() -> list[RecordedEvent]:
    """Stops of all kinds, a release, a cancel, and a task that is given up."""
    return happened(
        {"t_s": 1, "task": {"waypoints": STRAIGHT}},
        request(3, "PUT", "/holds/operator", reason="loading"),
        request(4, "DELETE", "/holds/operator"),
        request(6, "PUT", "/emergency_stop", engaged=True, reason="look"),
        request(8, "PUT", "/emergency_stop", engaged=False, reason="fine"),
        {"t_s": 9, "vehicle": "silent"},
        {"t_s": 10, "vehicle": "recover"},
        {"t_s": 11, "task": None},
        {"t_s": 12, "task": {"waypoints": STRAIGHT, "start_index": 8}},
        {"t_s": 40, "task": {"waypoints": [*STRAIGHT[27:], *reversed(STRAIGHT[:29])]}},
        until_s=80,
        vehicle={"plant": {"braking_mps2": 2.0, "acceleration_mps2": 2.0}},
        driving={"max_cross_track_m": 0.3},
    )


def soft_brakes() -> list[RecordedEvent]:
    """A stop that does not stop: without a pose for a while, and at last the vehicle stands."""
    return happened(
        {"t_s": 1, "task": {"waypoints": STRAIGHT}},
        request(4, "PUT", "/emergency_stop", engaged=True, reason="look"),
        {"t_s": 15, "vehicle": "silent"},
        {"t_s": 20, "vehicle": "recover"},
        until_s=40,
        vehicle={"plant": {"braking_mps2": 0.1}},
    )


def a_sick_robot() -> list[RecordedEvent]:
    """Errors that wait, clocks that differ, changes that end in every way."""
    mode = {"part": "actuation", "mode": "PERFORMANCE"}
    return happened(
        {"t_s": 1, "reading": {"gps_accuracy": 500}},
        {"t_s": 2, "reading": {"gps_accuracy": 10}, "stamp_offset_s": 5},
        {"t_s": 3, "reading": {"estop": True}},
        {"t_s": 4, "reading": {"estop": False}},
        request(5, "POST", "/errors/ESTOP/acknowledge"),
        {"t_s": 6, "change": mode},
        request(6.1, "DELETE", "/changes/c1"),
        {"t_s": 10, "change": mode},
        {"t_s": 10.1, "change": {"part": "drive_base", "mode": "SLOW"}},
        {"t_s": 15, "node": "drive_base", "parameters": {"max_speed": 0.5}},
        {"t_s": 16, "node": "manipulator", "fault": "refuse"},
        {"t_s": 17, "change": {"part": "manipulator", "transition": "cleanup"}},
        {"t_s": 20, "node": "manipulator", "fault": "slow"},
        {"t_s": 21, "change": {"part": "manipulator", "transition": "deactivate"}},
        {"t_s": 21.5, "node": "manipulator", "fault": "silent"},
        request(40, "PATCH", "/nodes/drive_base/parameters", max_speed=0.2),
        {"t_s": 50, "node": "drive_base", "fault": "die"},
        {"t_s": 55, "node": "drive_base", "fault": "recover"},
        until_s=60,
        signals={"stale_after_s": 0, "estop": {"recovery": "acknowledge"}},
        changes={"transition_deadline_s": 2.0},
    )


def a_lost_backend() -> list[RecordedEvent]:
    return told(BackendStatus(available=False, reason="no network"), BackendStatus(available=True))


def a_stop_on_another_computer() -> list[RecordedEvent]:
    arm = ComputerName("arm")
    stop = PeerStop(StopId("arm-1"), "ada", "a child", 0)
    release = EmergencyStopRequest(False, "the track is clear", Actor("ada"))
    engage = EmergencyStopRequest(True, "me too", Actor("bert"))
    return told(PeerStops(arm, (stop,)), engage, release, PeerStops(arm, ()), peers=(arm,))


def a_lost_drive_process() -> list[RecordedEvent]:
    return told(DriveStatus(available=False, reason="it has ended"), DriveStatus(available=True))


def a_lost_controller() -> list[RecordedEvent]:
    gone = NavigationStatus(available=False, reason="it gave no feedback for 1 s")
    return told(gone, NavigationStatus(available=True))


def a_write() -> list[RecordedEvent]:
    return told(
        WriteRecord("PUT", "/holds/operator", 200, "10.0.0.7:50000", Actor("http:10.0.0.7"))
    )


def a_stall() -> list[RecordedEvent]:
    return told(ServiceStall(1_500_000_000))


def a_full_disk() -> list[RecordedEvent]:
    full = StorageStatus(available=False, reason="the disk is full")
    return told(full, StorageStatus(available=True))


def a_publisher_that_does_not_match() -> list[RecordedEvent]:
    wrong = GraphFault(
        GraphFaultKind.QOS, "/scan", "lidar: best effort publisher and reliable subscription"
    )
    return told(wrong, GraphFault(GraphFaultKind.QOS, "/scan"))


def a_lost_sensor() -> list[RecordedEvent]:
    return told(SourceFault("temperature", "file /sys/class/thermal", "No such file"))


def an_error_that_comes_and_goes() -> list[RecordedEvent]:
    """A node is lost and heard again and again, until somebody shelves that for a while."""
    heard = [NodeReport(BASE, reachable=reachable) for reachable in (True, False) * 4]
    shelved = ShelveRequest("UNREACHABLE", seconds(600), "the cable is loose", part=BASE)
    return told(*heard, shelved, UnshelveRequest("UNREACHABLE", part=BASE))


def an_error_that_does_not_spread() -> list[RecordedEvent]:
    """The base is reported to slip, and the arm, which should shake, is not found to."""
    slips = ErrorKey(BASE, "SLIPS")
    shakes = DeclaredError(
        when=Condition("temperature > 90"), caused_by=(slips,), expected_within=seconds(1)
    )
    errors = {BASE: {"SLIPS": DeclaredError()}, ARM: {"SHAKES": shakes}}
    core = Supervision(replace(actuation_model(), errors=errors), SupervisionSettings(), 0)
    report = core.handle(ErrorReport(BASE, "SLIPS", active=True), 1)
    return [*report.events, *core.handle(TimePassed(), seconds(3)).events]


def a_mode_with_other_limits() -> list[RecordedEvent]:
    bound = Bound("LOAD_HIGH", Comparison.ABOVE, 60.0)
    limit = ModeLimit(bound, BASE, ModeName("FAST"))
    load = SignalSettings(SignalSpec("load", SignalKind.NUMBER), limits=(limit,))
    core = Supervision(actuation_model(), SupervisionSettings((*default_signals(), load)), 0)
    report = NodeReport(BASE, LifecycleState.ACTIVE, ModeName("FAST"))
    return list(core.handle(report, 1).events)


def a_restart() -> list[RecordedEvent]:
    kept = (
        KeptTarget(PartName("gripper"), StateAndMode(LifecycleState.ACTIVE), 1),
        KeptHold("operator", "lunch", "http:10.0.0.7", 0),
    )
    return told(Restored(kept, boot=2))


def a_lost_arm() -> list[RecordedEvent]:
    """A rule degrades the robot until it stays so; one that would activate does not act."""
    up = Rule("up", active(), (BASE, active("SLOW")), active("MODERATE"))
    robot = RuledRobot(degrading_model(up))
    robot.ask_mode("actuation", "__DEFAULT__")
    robot.advance(2)
    robot.stop()
    robot.somebody_sets("drive_base", "SLOW")
    robot.advance(2)
    robot.release_stop()
    robot.degraded().somebody_asks("manipulator", "activate")
    robot.advance(2)
    robot.degraded()
    robot.stop()
    robot.somebody_asks("manipulator", "activate")
    robot.advance(2)
    return robot.events


def a_step_left_out() -> list[RecordedEvent]:
    """A node reports a checkpoint that is not the next one."""
    order = CheckpointSettings(order={"sense": ("plan",), "plan": ("act",)})
    core = Supervision(actuation_model(), SupervisionSettings(checkpoints={BASE: order}), 0)
    inputs = (
        NodeReport(BASE, LifecycleState.ACTIVE),
        CheckpointReport(BASE, "sense"),
        CheckpointReport(BASE, "act"),
    )
    return [event for given in inputs for event in core.handle(given, 1).events]


def a_carrier_that_reacts() -> list[RecordedEvent]:
    """A reaction acts until it may no more, is acknowledged, overruled, and put on trial."""
    limp = 'LIMP: {when: "a", action: mode, target: active.SLOW, at_most: 1}'
    robot = ReactingRobot(limp, REST).see(a=True).see(b=True).see(b=False, a=False).see(a=True)
    robot.acknowledge_reaction("LIMP")
    robot.see(b=True)
    robot.stop()
    robot.see(a=False, b=False)
    robot.arm("LIMP", "passive")
    robot.release_stop()
    robot.see(a=True)
    return robot.events


def a_lost_device() -> list[RecordedEvent]:
    """A device is connected, late and lost; somebody else takes its name, and it is back."""
    robot = RobotOfDevices().connect_all()
    robot.says(DeviceState.LATE, reason="device arm has not been heard for 0.5 s")
    robot.lose()
    robot.says(DeviceState.CONFLICT, reason="device arm is not dealt with: it has another model")
    robot.connect(run=2)
    robot.says(DeviceState.CONNECTED, run=2, autonomous=True)
    return robot.events


def a_device_that_is_cut_off() -> list[RecordedEvent]:
    """A device follows, refuses under a stop, is cut off, does what it may, and follows again."""
    robot = DeviceRobot(offline(drive_base="active.SLOW"))
    robot.connect()
    robot.carry_out("drive_base", "configure")
    robot.stop()
    robot.order("drive_base", "activate")
    robot.be_late()
    robot.lose()
    robot.advance(3)
    robot.connect()
    return robot.events


def a_reaction_on_a_device() -> list[RecordedEvent]:
    """A device tells that a reaction acts which it decides about."""
    robot = FollowingRobot()
    robot.hear("acting")
    return robot.events


def a_process_that_is_given_up() -> list[RecordedEvent]:
    """The process of a node crashes too often, and an operator starts it again."""
    processes = {BASE: ProcessSettings(starts=2, first_back_off=seconds(1))}
    core = Supervision(actuation_model(), SupervisionSettings(processes=processes), 0)
    crash = ProcessReport(BASE, exit=ProcessExit(1))
    start = ProcessRequest(BASE, ProcessAction.START, Actor("ada"))
    inputs: tuple[Input, ...] = (
        ProcessReport(BASE),
        ProcessReport(BASE, 4001),
        crash,
        TimePassed(),
        crash,
        start,
    )
    return [
        event
        for at, given in enumerate(inputs)
        for event in core.handle(given, seconds(2 * at)).events
    ]


def a_wait() -> list[RecordedEvent]:
    """A request waits until the battery is charged."""
    robot = CoreRobot(guarded_model())
    robot.read(**{**GOOD, "battery_level": 0.2})
    robot.begin(ModeRequest(robot.model.parts[0], "PERFORMANCE", wait_for=seconds(60)))
    return robot.events


def told(*inputs: Input, peers: tuple[ComputerName, ...] = ()) -> list[RecordedEvent]:
    """Return the events of a core that is given what no scenario holds."""
    core = Supervision(actuation_model(), SupervisionSettings(peers=peers), 0)
    return [event for given in inputs for event in core.handle(given, 1).events]


def the_examples() -> list[RecordedEvent]:
    events: list[RecordedEvent] = []
    for path in sorted((FOLDER.parents[1] / "examples" / "scenarios").glob("*.yaml")):
        events += _example(path)
    return events


def _example(path: Path) -> list[RecordedEvent]:
    """Play a scenario that names no files."""
    text = yaml.safe_load(path.read_text(encoding="utf-8"))
    steps = [step for step in text["steps"] if not (step.get("task") or {}).get("file")]
    own = {key: value for key, value in text.items() if key != "title" and "_file" not in key}
    body = SimulationBody.model_validate({**own, "steps": steps})
    simulation = Simulation(body, robot_for(body, ACTUATION, None))
    simulation.run()
    return list(simulation.events)


def test_events_that_happen_are_listed_with_what_they_carry() -> None:
    seen: dict[str, list[set[str]]] = {}
    stories = (
        a_drive,
        soft_brakes,
        a_sick_robot,
        a_lost_backend,
        a_stop_on_another_computer,
        a_lost_drive_process,
        a_lost_controller,
        a_write,
        a_stall,
        a_restart,
        a_full_disk,
        a_publisher_that_does_not_match,
        a_lost_sensor,
        an_error_that_comes_and_goes,
        an_error_that_does_not_spread,
        a_mode_with_other_limits,
        a_lost_arm,
        a_carrier_that_reacts,
        a_device_that_is_cut_off,
        a_reaction_on_a_device,
        a_wait,
        a_lost_device,
        a_step_left_out,
        a_process_that_is_given_up,
        the_examples,
    )
    for event in (event for story in stories for event in story()):
        seen.setdefault(event.kind, []).append(set(event.data))

    assert set(seen) - set(EVENTS) == set()
    for name, carried in sorted(seen.items()):
        allowed = set(EVENTS[name].data_keys())
        always = allowed - EVENTS[name].optional
        assert all(always <= keys <= allowed for keys in carried), name
        assert allowed - set().union(*carried) <= NOT_BY_SIMULATED_NODES, name
    assert sorted(set(EVENTS) - set(seen)) == sorted(NEVER_SEEN_HERE)
