"""Which errors are on, and which can have been the first."""

from domain.events.service import TimeWasDue
from domain.health.on_errors import OnErrors
from domain.outbox import Outbox
from domain.snapshot import ErrorKey
from domain.state_and_mode import PartName

ARM, BASE = PartName("arm"), PartName("base")
LOST, OFF, LOW = ErrorKey(ARM, "LOST"), ErrorKey(BASE, "LOST"), ErrorKey(None, "LOW")


def test_errors_are_found_by_name_while_they_are_on() -> None:
    on = OnErrors(Outbox())
    for key in (LOST, OFF, LOW):
        on.switch(key, on=True)
    on.switch(LOST, on=False)
    assert (LOST in on, OFF in on, LOW in on) == (False, True, True)
    assert {name: list(parts) for name, parts in on.parts_by_name.items()} == {"LOST": [BASE]}
    assert (on.oldest, on.is_empty) == (OFF, False)


def test_what_switched_is_taken_once_and_in_order() -> None:
    on = OnErrors(Outbox())
    on.switch(OFF, on=True)
    on.switch(LOST, on=True)
    on.switch(OFF, on=False)
    assert on.take_switched() == (OFF, LOST)
    assert on.take_switched() == ()


def test_only_those_of_the_step_in_which_the_first_was_raised_can_be_first() -> None:
    outbox = Outbox()
    on = OnErrors(outbox)
    outbox.begin(0, TimeWasDue())
    on.switch(LOST, on=True)
    on.switch(OFF, on=True)
    outbox.begin(1, TimeWasDue())
    on.switch(LOW, on=True)
    assert list(on.contenders) == [LOST, OFF]
    for key in (LOST, OFF, LOW):
        on.switch(key, on=False)
    on.switch(LOW, on=True)
    assert list(on.contenders) == [LOW]
