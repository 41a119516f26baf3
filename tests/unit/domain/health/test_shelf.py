"""The shelf: what is on it, for how long, and over a restart."""

from domain.health.shelf import KEEPS_TIME_EVERY, Shelf, shelves_after
from domain.inputs import MAX_SHELF
from domain.kept import Kept, KeptClock, KeptShelf
from domain.outbox import Outbox
from domain.snapshot import ErrorKey, ShelfView
from domain.state_and_mode import PartName
from domain.timebase import seconds

LOW = ErrorKey(None, "BATTERY_LOW")
OFF = ErrorKey(PartName("arm"), "DEVIATES")
ARM_SHELF = KeptShelf(PartName("arm"), "DEVIATES", seconds(100), "known", "ada")


class Trial:
    """A shelf, and what is kept of it."""

    def __init__(self) -> None:
        self.outbox = Outbox()
        self.shelf = Shelf(self.outbox)
        self.kept: dict[str, Kept | None] = {}

    def put(self, key: ErrorKey, until_s: float, now_s: float = 0) -> None:
        view = ShelfView(seconds(until_s), "known", "ada")
        self.shelf.put(key, view, 7, seconds(now_s))
        self.take()

    def pass_time(self, now_s: float) -> list[str]:
        ended = [key.name for key, _ in self.shelf.pass_time(seconds(now_s))]
        self.take()
        return ended

    def take(self) -> None:
        for item in self.outbox.take().kept:
            self.kept[f"{item.kind.__name__} {item.name}".strip()] = item.value


def test_an_error_is_on_the_shelf_until_its_time_is_up() -> None:
    trial = Trial()
    trial.put(LOW, 60)
    shelved = trial.shelf[LOW]
    assert shelved is not None
    assert (shelved.until, shelved.reason, shelved.by) == (seconds(60), "known", "ada")
    assert trial.shelf[OFF] is None
    assert trial.pass_time(59.9) == []
    assert trial.pass_time(60) == ["BATTERY_LOW"]
    assert trial.shelf[LOW] is None
    assert trial.shelf.wake_at() is None


def test_shelving_anew_replaces_the_time() -> None:
    trial = Trial()
    trial.put(LOW, 60)
    trial.put(LOW, 20)
    assert trial.pass_time(20) == ["BATTERY_LOW"]
    assert trial.pass_time(60) == []


def test_what_is_shelved_is_kept_and_forgotten_with_its_end() -> None:
    trial = Trial()
    trial.put(OFF, 100)
    assert trial.kept == {"KeptShelf arm.DEVIATES": ARM_SHELF, "KeptClock": KeptClock(0)}
    trial.shelf.remove(OFF)
    trial.take()
    assert set(trial.kept.values()) == {None}


def test_the_time_is_kept_now_and_then_while_something_is_shelved() -> None:
    trial = Trial()
    trial.put(LOW, 60, now_s=10)
    due = trial.shelf.wake_at()
    assert due == seconds(10) + KEEPS_TIME_EVERY
    trial.pass_time(15)
    assert trial.kept["KeptClock"] == KeptClock(seconds(15))


def test_the_time_does_not_run_down_while_the_service_is_down() -> None:
    back = shelves_after((KeptClock(seconds(40)), ARM_SHELF), seconds(5_000))
    assert back == {OFF: ShelfView(seconds(5_060), "known", "ada")}


def test_a_clock_that_went_back_shelves_nothing_for_longer_than_is_allowed() -> None:
    (back,) = shelves_after((KeptClock(seconds(40)), ARM_SHELF), -2 * MAX_SHELF).values()
    assert back.until == -MAX_SHELF
