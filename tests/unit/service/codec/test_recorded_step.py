import pytest

from domain.computers import ComputerName
from domain.identifiers import ChangeId, TaskId
from domain.inputs import TimePassed
from domain.outbox import NOTHING, Outputs
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName
from service.codec.recorded_step import recorded_step

ARM, BASE = PartName("arm"), PartName("base")


def views_of(outputs: Outputs) -> int | None:
    return recorded_step(7, TimePassed(), False, outputs).views


def test_outputs_without_changed_views_have_no_checksum() -> None:
    assert views_of(NOTHING) == 0


def test_each_changed_view_has_its_own_checksum() -> None:
    changed = [
        Outputs(change=ChangeId("c1")),
        Outputs(task=TaskId("c1")),
        Outputs(parts=frozenset({ARM})),
        Outputs(signals=frozenset({"arm"})),
        Outputs(parts=frozenset({ARM, BASE})),
        Outputs(errors=frozenset({ErrorKey(ARM, "DEVIATES")})),
        Outputs(errors=frozenset({ErrorKey(None, "ESTOP")})),
        Outputs(devices=frozenset({ComputerName("arm")})),
        Outputs(devices=frozenset({ComputerName("arm"), ComputerName("base")})),
        Outputs(system_state=True),
        Outputs(task_changed=True),
        Outputs(vehicle_changed=True),
    ]

    assert len({0, *map(views_of, changed)}) == len(changed) + 1


def test_the_checksum_is_that_of_the_format() -> None:
    outputs = Outputs(parts=frozenset({BASE, ARM}), signals=frozenset({"estop"}), system_state=True)

    assert views_of(outputs) == 784_087_742


@pytest.mark.parametrize("is_late", [True, False])
def test_a_step_has_the_input_and_what_followed(*, is_late: bool) -> None:
    step = recorded_step(7, TimePassed(), is_late, NOTHING)

    assert (step.at, step.given, step.is_late) == (7, TimePassed(), is_late)
    assert (step.commands, step.events, step.kept) == ((), (), ())


def test_many_views_have_the_checksum_that_does_not_depend_on_their_order() -> None:
    names = [PartName(f"n{number}") for number in range(2_000)]
    there, back = Outputs(parts=frozenset(names)), Outputs(parts=frozenset(reversed(names)))

    assert views_of(there) == views_of(back) == views_of(there)
    assert views_of(there) != views_of(Outputs(parts=frozenset(names[1:])))
