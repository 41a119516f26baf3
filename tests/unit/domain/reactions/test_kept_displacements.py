"""Displacements over a restart."""

from domain.events.service import NotRestored
from domain.kept import Kept, KeptEffectiveTarget
from domain.lifecycle import LifecycleState
from domain.outbox import Outbox
from domain.parts.mode_inference import ModeInference
from domain.parts.system_model import Rule
from domain.parts.targets import Displacement
from domain.reactions.kept_displacements import KeptDisplacements
from domain.reactions.rule_watch import RuleWatch
from domain.snapshot import Because
from domain.state_and_mode import PartName, StateAndMode
from tests.support.models import ACTUATION, ARM, BASE, active, actuation_model, inactive

MODEL = actuation_model()
PARK = Rule("park", active("PERFORMANCE"), (BASE, inactive()), inactive())
WATCH = RuleWatch(ACTUATION, PARK, 0, ModeInference(MODEL))
RULE, RULES = Because.RULE, (WATCH,)
UNCONFIGURED = StateAndMode(LifecycleState.UNCONFIGURED)


class Requests:
    """Requests of parts, in numbers."""

    def __init__(self, newest: int, **of: int) -> None:
        self.newest = newest
        self._of = of

    def of(self, part: PartName) -> int:
        return self._of.get(part, 0)


def displaced() -> Displacement:
    targets = {ACTUATION: inactive(), BASE: inactive(), ARM: UNCONFIGURED}
    return Displacement(ACTUATION, targets, Because.RULE, "park", cause=7)


def kept_of(outbox: Outbox) -> list[Kept | None]:
    return [item.value for item in outbox.take().kept]


def parked(order: int = 1, after: int = 4, rule: str = "park") -> KeptEffectiveTarget:
    staying = {ARM: LifecycleState.UNCONFIGURED}
    return KeptEffectiveTarget(
        ACTUATION, inactive(), rule, order, after, cause=7, since=30, staying=staying
    )


def test_a_displacement_is_kept_with_what_it_leaves_as_it_is_until_it_ends() -> None:
    outbox = Outbox()
    kept, park = KeptDisplacements(MODEL, Requests(newest=4), outbox), displaced()
    kept.begin(park, 30)
    assert kept_of(outbox) == [parked()]
    assert kept.since(park) == 30
    kept.forget(park)
    assert kept_of(outbox) == [None]


def test_it_is_kept_anew_only_when_a_node_stays_elsewhere() -> None:
    outbox = Outbox()
    kept, park = KeptDisplacements(MODEL, Requests(newest=4), outbox), displaced()
    kept.begin(park, 30)
    outbox.take()
    kept.renew(park)
    assert kept_of(outbox) == []
    park.targets[BASE] = UNCONFIGURED
    kept.renew(park)
    (value,) = kept_of(outbox)
    assert isinstance(value, KeptEffectiveTarget)
    assert value.staying == dict.fromkeys((ARM, BASE), LifecycleState.UNCONFIGURED)


def test_what_was_kept_is_restored_in_its_order() -> None:
    kept = KeptDisplacements(MODEL, Requests(newest=4), Outbox())

    found = list(kept.restore((parked(2), parked(1)), RULE, RULES, 40))

    assert [watch for _, watch in found] == [WATCH, WATCH]
    assert kept.since(found[0][0]) == 30
    assert found[0][0].targets == displaced().targets
    assert (found[0][0].name, found[0][0].cause) == ("park", 7)


def test_a_part_of_which_something_was_requested_later_does_not_inherit() -> None:
    kept = KeptDisplacements(MODEL, Requests(newest=5, drive_base=5, manipulator=3), Outbox())

    ((park, _),) = kept.restore((parked(after=4),), RULE, RULES, 40)

    assert park.targets == {ACTUATION: inactive(), ARM: UNCONFIGURED}


def test_what_the_model_no_longer_says_is_left_out_and_told() -> None:
    outbox = Outbox()
    kept = KeptDisplacements(MODEL, Requests(newest=4), outbox)

    assert list(kept.restore((parked(rule="gone"),), RULE, RULES, 40)) == []

    outputs = outbox.take()
    told = [entry.event for entry in outputs.events if isinstance(entry.event, NotRestored)]
    assert told == [
        NotRestored(
            "the target inactive of actuation that a rule set",
            "the model has no rule 'gone' that sets it",
        )
    ]
    assert [item.value for item in outputs.kept] == [None]
