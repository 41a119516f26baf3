"""Who has seen which error, and what is silenced, as an operator finds it."""

from collections.abc import Mapping
from dataclasses import replace

import pytest

from domain.actor import Actor
from domain.conditions.condition import Condition
from domain.health.alarms import MAX_RETURNED
from domain.health.signals import default_signals
from domain.inputs import (
    AcknowledgeRequest,
    ModeRequest,
    NodeReport,
    Reading,
    Readings,
    Restored,
    ShelveRequest,
    TimePassed,
    TransitionRequest,
    UnshelveRequest,
)
from domain.kept import Kept, KeptShelf, KeptUnacknowledged
from domain.lifecycle import LifecycleState, Transition
from domain.outbox import Outputs
from domain.parts.declared_errors import DeclaredError
from domain.parts.system_model import SmhModel
from domain.snapshot import ErrorKey, ErrorState, ErrorView
from domain.state_and_mode import PartName
from domain.supervision import Supervision, SupervisionSettings
from domain.timebase import Duration, Instant, seconds
from tests.support.big_model import big_model
from tests.support.good import GOOD
from tests.support.models import ACTUATION, ARM, BASE, actuation_model
from tests.support.operator_verbs import OperatorVerbs

S = ErrorState
ADA = Actor("ada")
LOST = "UNREACHABLE"
LATCHING = {BASE: {LOST: DeclaredError(needs_acknowledgement=True)}}


def model_with(errors: Mapping[PartName, Mapping[str, DeclaredError]]) -> SmhModel:
    return replace(actuation_model(), errors=errors)


class Robot(OperatorVerbs[Outputs, None, None]):
    """A core whose nodes are heard, with the questions that these stories ask."""

    def __init__(
        self,
        model: SmhModel | None = None,
        start: Instant = 0,
        settings: SupervisionSettings | None = None,
    ) -> None:
        self.now = start
        settings = settings or SupervisionSettings()
        self.core = Supervision(model or actuation_model(), settings, start)
        self.kinds: list[str] = []
        self.kept: dict[tuple[type[Kept], str], Kept | None] = {}

    def give(self, given: object) -> Outputs:
        outputs = self.core.handle(given, self.now)  # type: ignore[arg-type]
        self.kinds += [event.kind for event in outputs.events]
        self.kept |= {(item.kind, item.name): item.value for item in outputs.kept}
        return outputs

    def begin(self, request: object) -> None:
        self.give(request)

    def advance(self, duration_s: float) -> None:
        self.now += seconds(duration_s)
        self.give(TimePassed())

    def hear(self, *, reachable: bool = True, node: str = BASE) -> None:
        """Let a node be heard, or let it be lost."""
        state = LifecycleState.UNCONFIGURED if reachable else None
        self.give(NodeReport(PartName(node), state=state, reachable=reachable))

    def flap(self, times: int) -> None:
        """Lose a node so often, for 1 s each, and hear it for 2 s."""
        for _ in range(times):
            self.hear(reachable=False)
            self.advance(1)
            self.hear()
            self.advance(2)

    def see(self, error: str = LOST, part: str | None = BASE) -> Outputs:
        return self.give(AcknowledgeRequest(error, ADA, _part(part)))

    def shelve(self, for_s: float = 600, error: str = LOST, part: str | None = BASE) -> Outputs:
        return self.give(ShelveRequest(error, seconds(for_s), "known", ADA, _part(part)))

    def error(self, error: str = LOST, part: str | None = BASE) -> ErrorView:
        return self.core.error(ErrorKey(_part(part), error))

    def state(self, error: str = LOST, part: str | None = BASE) -> ErrorState:
        return self.error(error, part).state

    def restarted(self, after_s: float = 100, model: SmhModel | None = None) -> "Robot":
        """Return the robot after a restart of the service."""
        kept = tuple(value for value in self.kept.values() if value is not None)
        robot = Robot(model or self.core.model, self.now + seconds(after_s))
        robot.give(Restored(kept, boot=2, next_event=1_000))
        return robot


def _part(name: str | None) -> PartName | None:
    return None if name is None else PartName(name)


@pytest.fixture
def robot() -> Robot:
    robot = Robot()
    robot.read(**GOOD)
    for node in (BASE, ARM):
        robot.hear(node=node)
    return robot


@pytest.fixture
def latching() -> Robot:
    """Return a robot that has to be told once its base, which was lost, is back."""
    robot = Robot(model_with(LATCHING))
    robot.hear()
    return robot


# --- seen ----------------------------------------------------------------------------------------


def test_how_each_robot_begins_is_nothing_to_see(robot: Robot) -> None:
    assert not robot.core.open_errors()


def test_an_error_that_ended_by_itself_has_returned_until_somebody_saw_it(robot: Robot) -> None:
    robot.hear(reachable=False)
    robot.advance(3)
    robot.hear()
    back = robot.error()
    assert (back.state, back.message) == (S.RETURNED, "drive_base is unreachable")
    assert (back.since, back.ended) == (0, seconds(3))
    assert not back.state.is_on
    robot.see()
    assert robot.state() is S.NORMAL
    assert robot.kinds[-1] == "error.acknowledged"


def test_who_saw_an_error_while_it_was_on_need_not_see_it_again(robot: Robot) -> None:
    robot.hear(reachable=False)
    robot.see()
    assert robot.state() is S.ACKNOWLEDGED
    robot.hear()
    assert robot.state() is S.NORMAL


def test_an_acknowledgement_is_void_when_the_cause_comes_again(robot: Robot) -> None:
    robot.hear(reachable=False)
    robot.see()
    robot.hear()
    robot.hear(reachable=False)
    assert robot.state() is S.ACTIVE


def test_errors_of_the_robot_itself_are_seen_likewise(robot: Robot) -> None:
    robot.read(battery_level=0.4)
    robot.see("BATTERY_LOW", None)
    assert robot.state("BATTERY_LOW", None) is S.ACKNOWLEDGED
    robot.read(battery_level=0.9)
    robot.advance(0.3)
    assert robot.state("BATTERY_LOW", None) is S.NORMAL


def test_to_acknowledge_what_is_normal_leaves_no_trace(robot: Robot) -> None:
    assert robot.see() == Outputs()


def test_an_error_that_has_to_be_acknowledged_stays_on_after_its_cause(latching: Robot) -> None:
    latching.hear(reachable=False)
    latching.advance(1)
    latching.hear()
    assert latching.state() is S.LATCHED
    assert "error.cleared" not in latching.kinds
    latching.see()
    assert latching.state() is S.NORMAL
    assert latching.kinds[-2:] == ["error.acknowledged", "error.cleared"]


def test_one_that_was_acknowledged_before_ends_with_its_cause(latching: Robot) -> None:
    latching.hear(reachable=False)
    latching.see()
    latching.hear()
    assert latching.state() is S.NORMAL
    assert latching.kinds[-1] == "error.cleared"


@pytest.fixture
def deviating(robot: Robot) -> Robot:
    """Return a robot that lost its base, which deviates because of that."""
    robot.give(TransitionRequest(BASE, Transition.CONFIGURE))
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE))
    robot.hear(reachable=False)
    robot.advance(2)
    assert robot.error("DEVIATES").roots == (ErrorKey(BASE, LOST),)
    return robot


def end(robot: Robot) -> None:
    robot.give(NodeReport(BASE, state=LifecycleState.INACTIVE, reachable=True))
    robot.advance(2)


def test_what_followed_from_an_error_is_seen_with_it(deviating: Robot) -> None:
    end(deviating)
    assert (deviating.state(), deviating.state("DEVIATES")) == (S.RETURNED, S.RETURNED)
    deviating.see()
    assert (deviating.state(), deviating.state("DEVIATES")) == (S.NORMAL, S.NORMAL)


def test_what_follows_from_an_error_that_was_seen_leaves_nothing_to_see(deviating: Robot) -> None:
    deviating.see()
    assert deviating.state("DEVIATES") is S.ACTIVE
    end(deviating)
    assert (deviating.state(), deviating.state("DEVIATES")) == (S.NORMAL, S.NORMAL)


def test_what_follows_from_another_error_is_not_kept_over_a_restart(deviating: Robot) -> None:
    unseen = {name for kind, name in deviating.kept if kind is KeptUnacknowledged}
    kept = {name for name in unseen if deviating.kept[KeptUnacknowledged, name] is not None}
    assert kept == {"drive_base.UNREACHABLE"}


def test_a_signal_whose_error_is_over_still_says_what_was_measured() -> None:
    robot = Robot()
    robot.give(Readings(tuple(Reading(*good) for good in GOOD.items()), "test"))
    for level, after_s in ((0.42, 1.0), (0.9, 0.05)):
        robot.give(Readings((Reading("battery_level", level),), "test"))
        robot.advance(after_s)
        error = robot.error("BATTERY_LOW", None)
        assert (error.message, error.value) == ("battery 42 % is below 50 %", 0.42)
    robot.give(Readings((Reading("battery_level", 0.2),), "test"))
    robot.give(Readings((Reading("battery_level", 0.9),), "test"))
    robot.advance(0.5)
    over = robot.error("BATTERY_LOW", None)
    assert (over.state, over.message) == (S.RETURNED, "battery 20 % is below 50 %")


def test_of_very_many_that_returned_the_oldest_count_as_seen() -> None:
    model = big_model(MAX_RETURNED + 10)
    robot = Robot(model)
    for node in model.nodes:
        robot.hear(node=node)
    for reachable in (False, True):
        for node in model.nodes:
            robot.hear(reachable=reachable, node=node)
    while robot.core.wake_at() == robot.now:
        robot.give(TimePassed())
    returned = [view.key.part for view in robot.core.errors() if view.state is S.RETURNED]
    assert returned == list(model.nodes)[-MAX_RETURNED:]


# --- silenced ------------------------------------------------------------------------------------


def test_a_shelved_error_is_told_as_such_for_a_time_and_stays_as_it_is(robot: Robot) -> None:
    robot.shelve(600)
    robot.hear(reachable=False)
    shelf = robot.error().marks.shelf
    assert shelf is not None
    assert (shelf.until, shelf.reason, shelf.by) == (seconds(600), "known", ADA.label)
    assert robot.state() is S.ACTIVE
    robot.advance(599)
    assert robot.error().marks.is_silenced
    robot.advance(1)
    assert not robot.error().marks.is_silenced
    assert robot.kinds.count("error.unshelved") == 1


def test_what_is_silenced_is_not_in_a_short_list_of_events(robot: Robot) -> None:
    robot.shelve(error="BATTERY_LOW", part=None)
    for level in (0.4, 0.9):
        told = {event.kind: event.event for event in robot.read(battery_level=level).events}
        robot.advance(0.3)
        assert told["error.raised" if level < 0.5 else "error.cleared"].notable is False


def test_somebody_may_end_the_shelving_before(robot: Robot) -> None:
    robot.shelve()
    robot.give(UnshelveRequest(LOST, ADA, BASE))
    assert robot.error().marks.shelf is None
    assert robot.kinds[-2:] == ["error.shelved", "error.unshelved"]
    assert robot.give(UnshelveRequest(LOST, ADA, BASE)) == Outputs()


def test_a_shelved_error_is_listed_among_the_open_ones_though_it_is_normal(robot: Robot) -> None:
    robot.shelve()
    assert list(robot.core.open_errors()) == ["drive_base.UNREACHABLE"]
    robot.give(UnshelveRequest(LOST, ADA, BASE))
    assert not robot.core.open_errors()


def test_the_model_suppresses_an_error_while_a_condition_is_true() -> None:
    errors = {BASE: {LOST: DeclaredError(suppressed_when=Condition("hold.service_work"))}}
    robot = Robot(model_with(errors))
    robot.hear()
    assert not robot.error().marks.suppressed
    robot.hold("service_work")
    assert robot.error().marks.suppressed
    robot.hear(reachable=False)
    assert robot.state() is S.ACTIVE
    robot.release("service_work")
    assert not robot.error().marks.suppressed


def test_an_unknown_condition_suppresses_nothing() -> None:
    errors = {BASE: {LOST: DeclaredError(suppressed_when=Condition("battery_level < 0.5"))}}
    robot = Robot(model_with(errors))
    assert not robot.error().marks.suppressed
    robot.read(**{**GOOD, "battery_level": 0.4})
    assert robot.error().marks.suppressed
    robot.advance(5)
    assert not robot.error().marks.suppressed, "the battery is stale"


def test_an_error_that_comes_and_goes_chatters_with_what_would_calm_it(robot: Robot) -> None:
    robot.flap(2)
    assert not robot.error().marks.chattering
    robot.flap(1)
    assert robot.error().marks.chattering
    assert robot.error().marks.calming == seconds(2.1)
    assert robot.kinds.count("error.chattering") == 1
    robot.flap(1)
    assert robot.kinds.count("error.chattering") == 1
    robot.advance(600)
    assert not robot.error().marks.chattering


def flapping(clear_for: Duration) -> Robot:
    """Return a robot whose battery was low for 1 s, and not for 2 s, several times."""
    battery, *others = default_signals()
    signals = (replace(battery, clear_for=clear_for, stale_after=0), *others)
    robot = Robot(settings=SupervisionSettings(signals=signals))
    for _ in range(6):
        for level, lasts_s in ((0.4, 1), (0.9, 2)):
            robot.read(battery_level=level)
            robot.advance(lasts_s)
    return robot


def test_the_time_that_is_advised_calms_the_error() -> None:
    chattering = flapping(0).error("BATTERY_LOW", None)
    assert (chattering.marks.chattering, chattering.count) == (True, 6)
    assert chattering.marks.calming is not None
    calm = flapping(chattering.marks.calming).error("BATTERY_LOW", None)
    assert (calm.marks.chattering, calm.count) == (False, 1)


# --- over a restart ------------------------------------------------------------------------------


def test_what_nobody_saw_has_returned_after_a_restart(robot: Robot) -> None:
    robot.read(battery_level=0.4)
    after = robot.restarted()
    low = after.error("BATTERY_LOW", None)
    assert (low.state, low.value, low.since) == (S.RETURNED, 0.4, 0)
    after.see("BATTERY_LOW", None)
    assert after.state("BATTERY_LOW", None) is S.NORMAL
    assert after.kept[KeptUnacknowledged, "BATTERY_LOW"] is None


def test_what_was_seen_is_not_kept(robot: Robot) -> None:
    robot.read(battery_level=0.4)
    robot.see("BATTERY_LOW", None)
    assert robot.restarted().state("BATTERY_LOW", None) is S.NORMAL


def test_an_error_is_kept_once_however_often_it_comes(robot: Robot) -> None:
    robot.flap(1)
    robot.kept.clear()
    robot.flap(2)
    assert not robot.kept


def test_a_latched_error_is_on_after_a_restart(latching: Robot) -> None:
    latching.hear(reachable=False)
    latching.hear()
    after = latching.restarted()
    after.hear()
    assert after.state() is S.LATCHED
    after.see()
    assert after.state() is S.NORMAL


def test_a_node_that_was_lost_before_a_restart_has_returned_once_it_is_heard(robot: Robot) -> None:
    robot.hear(reachable=False)
    after = robot.restarted()
    assert after.state() is S.ACTIVE
    after.hear()
    assert after.state() is S.RETURNED


def test_a_shelving_survives_and_does_not_run_down_while_the_service_is_down(
    robot: Robot,
) -> None:
    robot.shelve(60)
    robot.advance(50)
    after = robot.restarted(after_s=5_000)
    assert after.error().marks.is_silenced
    after.advance(9)
    assert after.error().marks.is_silenced
    after.advance(6)
    assert not after.error().marks.is_silenced


def test_a_node_that_is_heard_after_a_restart_is_shelved_as_before(robot: Robot) -> None:
    robot.shelve(60)
    after = robot.restarted()
    after.hear()
    assert (after.state(), after.error().marks.is_silenced) == (S.NORMAL, True)


def test_errors_that_no_longer_exist_are_told_and_forgotten(robot: Robot) -> None:
    robot.hear(reachable=False)
    robot.shelve()
    after = robot.restarted(model=SmhModel({}, {}))
    assert after.kinds.count("service.not_restored") == 2
    name = "drive_base.UNREACHABLE"
    assert after.kept == {(KeptShelf, name): None, (KeptUnacknowledged, name): None}


def test_what_a_robot_asked_for_is_not_changed_by_shelving(robot: Robot) -> None:
    robot.shelve(error="DEVIATES", part=ACTUATION)
    robot.give(ModeRequest(ACTUATION, "PERFORMANCE", ADA))
    assert robot.core.part(ACTUATION).change is not None
