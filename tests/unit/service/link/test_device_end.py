"""A device tells the supervisor what its core takes in, whoever said it."""

from domain.inputs import (
    CheckpointReport,
    ErrorReport,
    Input,
    NodeAnswer,
    NodeReport,
    Reading,
    Readings,
    SourceFault,
    TimePassed,
)
from service.link.device_end import DeviceEnd
from service.link.status import LinkStatus
from tests.support.manual_clock import ManualClock
from tests.support.models import ARM
from tests.support.scripted_machine import DeadEnd, ScriptedMachine


def noted(*given: Input) -> ScriptedMachine:
    """Return the machine of a device whose core took something in."""
    machine = ScriptedMachine()
    end = DeviceEnd(machine, DeadEnd(), ManualClock(), LinkStatus({}))
    for each in given:
        end.note(each)
    return machine


def test_all_that_is_about_nodes_and_signals_is_told() -> None:
    given = (
        NodeReport(ARM, reachable=True),
        Readings((Reading("motor_temperature", 40.0),), "a person"),
        SourceFault("motor_temperature", "os", "no such sensor"),
        ErrorReport(ARM, "JAMMED", active=True),
        CheckpointReport(ARM, "planned"),
    )

    assert noted(*given).noted == list(given)


def test_an_answer_of_a_node_is_told_by_the_core_which_knows_whom_it_is_for() -> None:
    assert noted(NodeAnswer(1, ARM, accepted=True)).noted == []


def test_time_that_passes_is_not_told() -> None:
    assert noted(TimePassed()).noted == []
