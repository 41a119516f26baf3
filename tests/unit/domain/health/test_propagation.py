"""Errors that the model file declares, as an operator sees them come and go."""

from dataclasses import replace
from typing import Any

from domain.health.propagation import LOOKS_AT_ONCE
from domain.health.signals import default_signals
from domain.inputs import ErrorReport, NodeReport, Reading, Readings, TimePassed
from domain.lifecycle import Transition
from domain.simulation.node_settings import Fault
from domain.snapshot import ErrorKey, ErrorState, ErrorView, SystemState
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from service.checkpoint import checkpoint_of, core_of_checkpoint
from service.files.model_file import read_model
from tests.support.core_robot import CoreRobot
from tests.support.good import GOOD

S = ErrorState
NEVER_STALE = tuple(replace(signal, stale_after=0) for signal in default_signals())

SENSORS = """\
vehicle:
  ros__parameters:
    type: system
    modes: {__DEFAULT__: {lidar: active, camera: active, mapper: active}}
    errors:
      BLIND: {caused_by: [mapper.LATE, camera.SILENT], need: all, severity: critical}
lidar:
  ros__parameters:
    type: node
    errors:
      SILENT: {when: "not lidar.reachable", for_s: 0.5}
      DIRTY: {severity: warning}
camera:
  ros__parameters:
    type: node
    errors:
      SILENT: {when: "not camera.reachable", for_s: 0.5}
mapper:
  ros__parameters:
    type: node
    errors:
      LATE: {caused_by: [lidar.SILENT], after_s: 1, severity: urgent}
"""


def node(name: str, errors: str) -> str:
    return f"{name}: {{ros__parameters: {{type: node, errors: {errors}}}}}\n"


class Robot(CoreRobot):
    """A simulated robot of a model file, with the questions that these stories ask."""

    def __init__(self, text: str) -> None:
        super().__init__(read_model(text).model)
        self.read(**GOOD)

    def error(self, name: str) -> ErrorView:
        part, _, error = name.rpartition(".")
        return self.core.error(ErrorKey(PartName(part) if part else None, error))

    def on(self) -> list[str]:
        return [name for name, view in self.core.open_errors().items() if view.state.is_on]

    def roots(self, name: str) -> list[str]:
        return [key.name for key in self.error(name).roots]

    def told(self) -> list[tuple[str, str]]:
        """Return kind and error of all of parts that was raised and cleared, in order."""
        return [
            (event.kind.partition(".")[2], ErrorKey(event.data["part"], event.data["error"]).name)  # type: ignore[arg-type]
            for event in self.events
            if event.kind in ("error.raised", "error.cleared") and event.data["part"]
        ]

    def report(self, name: str, *, active: bool = True, **more: Any) -> None:  # noqa: ANN401
        part, _, error = name.rpartition(".")
        self.give(ErrorReport(PartName(part), error, active, **more))

    def pass_time(self, duration_s: float) -> None:
        """Let time pass while good readings arrive."""
        for _ in range(round(duration_s)):
            self.advance(1)
            self.read(**GOOD)


def sensors() -> Robot:
    """Return a robot whose sensors are active."""
    robot = Robot(SENSORS)
    robot.ask_transition("vehicle", Transition.ACTIVATE)
    robot.pass_time(5)
    robot.events.clear()
    return robot


# --- one cause -----------------------------------------------------------------------------------


def test_a_node_that_dies_is_one_error_with_all_others_under_it() -> None:
    robot = sensors()
    robot.fault("lidar", Fault.SILENT)
    robot.pass_time(5)
    on = sorted(robot.on())
    assert on == [
        "lidar.DEVIATES",
        "lidar.SILENT",
        "lidar.UNREACHABLE",
        "mapper.LATE",
        "vehicle.DEVIATES",
    ]
    views = [robot.error(name) for name in on]
    assert [view.key.name for view in views if view.is_root] == ["lidar.UNREACHABLE"]
    lost = (ErrorKey(PartName("lidar"), "UNREACHABLE"),)
    assert {view.roots for view in views if not view.is_root} == {lost}
    assert [view.key.name for view in views if view.first_out] == ["lidar.UNREACHABLE"]
    notable = [e.event.words for e in robot.events if e.kind == "error.raised" and e.event.notable]
    assert notable == []


def test_when_the_node_is_back_all_are_over_in_one_step_and_nothing_flickers() -> None:
    robot = sensors()
    robot.fault("lidar", Fault.SILENT)
    robot.pass_time(5)
    raised = [name for kind, name in robot.told() if kind == "raised"]
    robot.fault("lidar", None)
    robot.pass_time(5)
    assert robot.on() == []
    assert sorted(name for kind, name in robot.told() if kind == "cleared") == sorted(raised)
    cleared = [event.at for event in robot.events if event.kind == "error.cleared"]
    assert len(set(cleared)) == 1


def test_each_event_names_the_one_that_it_follows_from() -> None:
    robot = sensors()
    robot.fault("lidar", Fault.SILENT)
    robot.pass_time(5)
    by_id = {event.id: event for event in robot.events}
    late = next(e for e in robot.events if e.data.get("error") == "LATE")
    assert late.data["root_cause"] is False
    silent = by_id[late.cause or 0]
    assert (silent.kind, silent.data["error"]) == ("error.raised", "SILENT")
    assert by_id[silent.cause or 0].kind == "node.reported"


def test_a_severe_error_of_a_part_sets_the_shared_bit_and_holds_the_task() -> None:
    robot = sensors()
    for name in ("lidar", "camera"):
        robot.fault(name, Fault.SILENT)
    robot.pass_time(5)
    view = robot.core.system_state()
    assert (view.state, view.error_code, view.errors) == (
        SystemState.ERROR,
        128,
        ("vehicle.BLIND",),
    )
    (reason,) = view.reasons
    assert (reason.code, reason.path, reason.root_cause) == ("BLIND", ("vehicle",), False)
    assert [cause.path for cause in reason.causes] == [("lidar",), ("camera",)]
    assert "error" in robot.core.driving.holds
    assert robot.roots("vehicle.BLIND") == ["lidar.UNREACHABLE", "camera.UNREACHABLE"]
    robot.fault("camera", None)
    robot.pass_time(3)
    assert robot.core.system_state().state is SystemState.IDLE
    assert "error" not in robot.core.driving.holds


def test_the_state_changes_because_of_the_error_that_changed_it() -> None:
    robot = sensors()
    for name in ("lidar", "camera"):
        robot.fault(name, Fault.SILENT)
    robot.pass_time(5)
    changed = next(e for e in robot.events if e.kind == "system_state.changed")
    cause = next(e for e in robot.events if e.id == changed.cause)
    assert (cause.kind, cause.data["error"]) == ("error.raised", "BLIND")


# --- how long, and until when --------------------------------------------------------------------


def test_a_condition_has_to_be_true_for_some_time_and_false_for_some_time() -> None:
    robot = Robot(node("lidar", '{HOT: {when: "temperature > 40", for_s: 1, clear_for_s: 2}}'))
    robot.read(temperature=45.0)
    assert robot.error("lidar.HOT").state is S.PENDING
    robot.advance(0.9)
    assert robot.error("lidar.HOT").state is S.PENDING
    robot.advance(0.1)
    hot = robot.error("lidar.HOT")
    assert (hot.state, hot.message, hot.value, hot.threshold) == (
        S.ACTIVE,
        "temperature > 40",
        45.0,
        40,
    )
    robot.read(temperature=30.0)
    robot.advance(1)
    robot.read(temperature=45.0)
    robot.read(temperature=30.0)
    robot.advance(1.9)
    assert robot.error("lidar.HOT").state is S.ACTIVE
    robot.advance(0.1)
    assert not robot.error("lidar.HOT").state.is_on
    assert robot.told() == [("raised", "lidar.HOT"), ("cleared", "lidar.HOT")]


def test_a_condition_that_ends_in_time_raises_nothing() -> None:
    robot = Robot(node("lidar", '{HOT: {when: "temperature > 40", for_s: 1}}'))
    robot.read(temperature=45.0)
    robot.advance(0.5)
    robot.read(temperature=30.0)
    robot.advance(5)
    assert robot.error("lidar.HOT").state is S.NORMAL
    assert ("raised", "lidar.HOT") not in robot.told()


def test_what_is_not_known_any_more_keeps_an_error_and_begins_none() -> None:
    robot = Robot(
        node(
            "lidar", '{HOT: {when: "temperature > 40"}, COLD: {when: "temperature < 0", for_s: 3}}'
        )
    )
    robot.read(temperature=45.0)
    robot.advance(5)
    assert robot.core.signals()["temperature"].value is not None
    assert robot.core.signals()["temperature"].stale
    assert robot.error("lidar.HOT").state is S.ACTIVE
    robot.read(temperature=-5.0)
    assert not robot.error("lidar.HOT").state.is_on
    robot.advance(10)
    assert robot.error("lidar.COLD").state is S.NORMAL, "it was cold for 2 s, and then unknown"


def test_what_follows_may_take_its_time_and_ends_at_once() -> None:
    robot = sensors()
    robot.fault("lidar", Fault.SILENT)
    while "lidar.SILENT" not in robot.on():
        robot.advance(0.1)
    assert robot.error("mapper.LATE").state is S.PENDING
    robot.fault("lidar", None)
    robot.advance(0.1)
    assert robot.error("mapper.LATE").state is S.NORMAL
    assert ("raised", "mapper.LATE") not in robot.told()


def test_any_cause_is_enough_unless_all_are_needed() -> None:
    robot = Robot(
        node("arm", "{A: {severity: warning}, B: {severity: warning}}")
        + node(
            "base",
            "{ANY: {caused_by: [arm.A, arm.B]}, ALL: {caused_by: [arm.A, arm.B], need: all}}",
        )
    )
    robot.report("arm.A")
    assert robot.on() == ["arm.A", "base.ANY"]
    robot.report("arm.B")
    assert robot.on() == ["arm.A", "base.ANY", "arm.B", "base.ALL"]
    assert robot.error("base.ALL").message == "follows from arm.A, arm.B"
    robot.report("arm.A", active=False)
    assert robot.on() == ["base.ANY", "arm.B"]
    assert robot.roots("base.ANY") == ["arm.B"]


def test_an_error_does_not_follow_while_its_exception_is_true() -> None:
    robot = Robot(
        node("arm", "{A: {severity: warning}}")
        + node("base", '{BAD: {caused_by: arm.A, unless: "temperature < 30"}}')
    )
    robot.read(temperature=20.0)
    robot.report("arm.A")
    assert robot.on() == ["arm.A"]
    robot.read(temperature=35.0)
    assert robot.on() == ["arm.A", "base.BAD"]
    robot.read(temperature=20.0)
    assert robot.on() == ["arm.A"]
    robot.advance(5)
    assert "base.BAD" in robot.on(), "what is not known is no exception"


# --- roots ---------------------------------------------------------------------------------------


def test_an_error_of_its_own_keeps_its_root_until_it_is_over() -> None:
    robot = Robot(
        node("arm", "{A: {severity: warning}}")
        + node("base", '{HOT: {when: "temperature > 40", caused_by: [arm.A]}}')
        + node("head", "{WORSE: {caused_by: [base.HOT]}}")
    )
    robot.read(temperature=45.0)
    assert robot.roots("base.HOT") == []
    assert robot.roots("head.WORSE") == ["base.HOT"]
    robot.report("arm.A")
    assert robot.roots("base.HOT") == ["arm.A"]
    assert robot.roots("head.WORSE") == ["arm.A"], "the whole chain has another root"
    robot.report("arm.A", active=False)
    assert robot.roots("base.HOT") == ["arm.A"]
    robot.read(temperature=20.0)
    robot.read(temperature=45.0)
    assert robot.roots("base.HOT") == []


def test_of_three_causes_in_one_step_one_is_the_first_whatever_follows_from_them() -> None:
    robot = Robot(
        node("late", "{E: {caused_by: [hot.E]}}")
        + node("hot", '{E: {when: "temperature > 40"}}')
        + node("flat", '{E: {when: "battery_level < 0.6"}}')
        + node("near", '{E: {when: "battery_level < 0.7"}}')
    )
    robot.read(temperature=45.0, battery_level=0.55)
    first = [name for name in robot.on() if robot.error(name).first_out]
    assert first == ["hot.E"], "late.E stands before it, and follows from it"
    assert sorted(robot.on()) == ["flat.E", "hot.E", "late.E", "near.E"]


def test_nothing_is_raised_that_another_error_of_the_same_step_prevents() -> None:
    robot = Robot(
        node("a", '{E: {when: "b.errors.HOT and not c.errors.HOT"}}')
        + node("b", '{HOT: {when: "temperature > 40"}}')
        + node("c", '{HOT: {when: "b.errors.HOT"}}')
    )
    robot.read(temperature=45.0)
    assert [name for _, name in robot.told()] == ["b.HOT", "c.HOT"]


# --- what should have followed -------------------------------------------------------------------


def test_a_cause_without_the_effect_that_it_should_have_is_told_once() -> None:
    robot = Robot(
        node("arm", "{A: {severity: warning}}")
        + node(
            "base",
            '{HOT: {when: "temperature > 40", caused_by: [arm.A], expected_within_s: 2}}',
        )
    )
    robot.report("arm.A")
    robot.advance(1.9)
    assert robot.happened("propagation.not_seen") == []
    robot.advance(10)
    assert robot.happened("propagation.not_seen") == [
        {
            "error": "HOT",
            "part": "base",
            "cause_error": "A",
            "cause_part": "arm",
            "within_s": 2.0,
        }
    ]


def test_a_cause_that_ends_in_time_or_whose_effect_comes_is_as_expected() -> None:
    robot = Robot(
        node("arm", "{A: {severity: warning}}")
        + node(
            "base",
            '{HOT: {when: "temperature > 40", caused_by: [arm.A], expected_within_s: 2}}',
        )
    )
    robot.report("arm.A")
    robot.advance(1)
    robot.report("arm.A", active=False)
    robot.advance(5)
    robot.report("arm.A")
    robot.read(temperature=45.0)
    robot.advance(5)
    assert robot.happened("propagation.not_seen") == []


# --- the start -----------------------------------------------------------------------------------


def test_what_goes_back_to_nodes_that_were_never_heard_of_is_on_without_a_word() -> None:
    text = node("lidar", '{SILENT: {when: "not lidar.reachable"}}')
    text += node("base", "{BLIND: {caused_by: [lidar.SILENT], severity: critical}}")
    robot = Robot(text)
    assert robot.on() == []
    assert robot.told() == []
    assert robot.error("lidar.SILENT").count == 0
    robot.fault("lidar", Fault.SILENT)
    robot.advance(5)
    assert ("raised", "base.BLIND") in robot.told()


def test_what_was_on_without_a_word_is_told_with_its_first_cause_that_is_news() -> None:
    lidar, camera = PartName("lidar"), PartName("camera")
    text = node("lidar", "{DIRTY: {severity: warning}}") + node("camera", "{OLD: {hint: mend it}}")
    text += node("base", "{BLIND: {caused_by: [lidar.UNREACHABLE, camera.OLD]}}")
    core = Supervision(read_model(text).model, SupervisionSettings(NEVER_STALE), 0)
    blind = ErrorKey(PartName("base"), "BLIND")
    told: list[str] = []

    def give(given: object, at: int) -> None:
        events = core.handle(given, at).events  # type: ignore[arg-type]
        told.extend(e.kind for e in events if e.data.get("error") == "BLIND")

    give(NodeReport(camera, reachable=True), 1)
    assert (core.error(blind).state.is_on, told) == (True, []), "the lidar was never heard of"
    give(ErrorReport(camera, "OLD", active=True), 2)
    assert told == ["error.raised"]
    give(NodeReport(lidar, reachable=True), 3)
    give(ErrorReport(camera, "OLD", active=False), 4)
    assert told == ["error.raised", "error.cleared"]
    assert core.error(blind).state is S.RETURNED, "nobody has seen it"


def test_a_robot_goes_on_from_a_checkpoint_as_it_was() -> None:
    robot = sensors()
    robot.fault("lidar", Fault.SILENT)
    robot.advance(2.7)
    robot.onboard = core_of_checkpoint(checkpoint_of(robot.onboard, "1"), "1")
    robot.core = robot.onboard.core
    robot.pass_time(3)
    assert "mapper.LATE" in robot.on()
    assert robot.roots("mapper.LATE") == ["lidar.UNREACHABLE"]


# --- large robots --------------------------------------------------------------------------------


def test_thousands_that_follow_at_once_are_decided_about_in_portions() -> None:
    count = 5 * LOOKS_AT_ONCE
    text = node("net", "{DOWN: {severity: urgent}}")
    text += "".join(node(f"n{i}", "{CUT: {caused_by: [net.DOWN]}}") for i in range(count))
    robot = Robot(text)
    told = [len(robot.give(ErrorReport(PartName("net"), "DOWN", active=True)).errors)]
    while robot.core.wake_at() == robot.now:
        told.append(len(robot.give(TimePassed()).errors))
    assert len(robot.on()) == count + 1
    assert max(told) <= 2 * LOOKS_AT_ONCE
    raised = next(e for e in robot.events if e.data.get("part") == f"n{count - 1}")
    assert raised.cause is not None


def test_that_a_node_was_not_yet_heard_of_begins_nothing_that_stays() -> None:
    text = node("lidar", '{BAD: {when: "not lidar.reachable or temperature > 40"}}')
    cold = CoreRobot(read_model(text).model)
    assert cold.core.signals()["temperature"].value is None
    bad = ErrorKey(PartName("lidar"), "BAD")
    assert cold.core.error(bad).state is S.NORMAL, "the temperature is not known"


def test_a_node_that_was_not_yet_heard_of_explains_nothing_once_it_is_heard() -> None:
    strong = "signal_strength == CONNECTED"
    text = node("lidar", f"{{OLD: {{when: {strong!r}, caused_by: [lidar.UNREACHABLE]}}}}")
    core = Supervision(read_model(text).model, SupervisionSettings(), 0)
    old = ErrorKey(PartName("lidar"), "OLD")
    core.handle(Readings((Reading("signal_strength", "CONNECTED"),), "test"), 1)
    assert core.error(old).roots == (ErrorKey(PartName("lidar"), "UNREACHABLE"),)
    core.handle(NodeReport(PartName("lidar"), reachable=True), 2)
    assert (core.error(old).state.is_on, core.error(old).roots) == (True, ())


def test_when_the_first_one_is_forgotten_the_next_one_was_the_first() -> None:
    text = node("lidar", "{DIRTY: {severity: warning}}")
    core = Supervision(read_model(text).model, SupervisionSettings(NEVER_STALE), 0)
    core.handle(ErrorReport(PartName("lidar"), "DIRTY", active=True), 1)
    core.handle(NodeReport(PartName("lidar"), reachable=True), 2)
    assert [view.key.name for view in core.errors() if view.first_out] == ["lidar.DIRTY"]
