import hypothesis.strategies as st
from hypothesis import given

from domain.actor import Actor
from domain.computers import DeviceState
from domain.inputs import (
    CancelTaskRequest,
    EmergencyStopRequest,
    HoldRequest,
    ReleaseRequest,
    TaskRequest,
)
from domain.snapshot import ErrorState, PartView, TaskPhase
from domain.state_and_mode import PartName
from service.frame_feed import ENDED_KEPT, LARGE, Frame, FrameFeed, FrameReader
from tests.support.frames import device_view, error_view, frame, part_view, signal_view
from tests.support.live_robot import make_supervisor, running
from tests.support.manual_clock import ManualClock
from tests.support.paths import straight

ARM = part_view("arm")
DRIVE = part_view("drive_base")
BATTERY = signal_view("battery_level")


def started() -> FrameFeed:
    feed = FrameFeed()
    feed.publish(frame(1, [ARM, DRIVE], [BATTERY], full=True))
    return feed


def taken(reader: FrameReader) -> tuple[Frame, int]:
    found = reader.take()
    assert found is not None
    return found


def test_a_new_reader_begins_with_everything() -> None:
    feed = started()
    feed.publish(frame(2))

    newest, skipped = taken(FrameReader(feed))

    assert (newest.seq, newest.full, skipped) == (2, True, 0)
    assert newest.parts == {"arm": ARM, "drive_base": DRIVE}
    assert newest.signals == {"battery_level": BATTERY}


def test_a_reader_in_step_gets_each_frame_as_it_was_published() -> None:
    feed = started()
    reader = FrameReader(feed)
    reader.take()
    published = frame(2, [part_view("arm", "STRONG")])

    feed.publish(published)

    assert taken(reader) == (published, 0)


def test_there_is_nothing_to_take_twice() -> None:
    feed = started()
    reader = FrameReader(feed)
    reader.take()

    assert reader.take() is None


def test_a_slow_reader_gets_the_newest_frame_whole_and_is_told_how_many_it_missed() -> None:
    feed = started()
    reader = FrameReader(feed)
    reader.take()
    moved = part_view("arm", "STRONG")
    feed.publish(frame(2, [moved]))
    feed.publish(frame(3))
    feed.publish(frame(4))

    newest, skipped = taken(reader)

    assert (newest.seq, newest.full, skipped) == (4, True, 2)
    assert newest.parts == {"arm": moved, "drive_base": DRIVE}


def test_a_reader_that_missed_frames_gets_all_devices_as_they_are_now() -> None:
    feed = FrameFeed()
    arm, base = device_view("arm"), device_view("base")
    feed.publish(frame(1, devices=[arm, base], full=True))
    reader = FrameReader(feed)
    reader.take()
    lost = device_view("arm", DeviceState.LOST)
    feed.publish(frame(2, devices=[lost]))
    feed.publish(frame(3))

    newest, _ = taken(reader)

    assert newest.devices == {"arm": lost, "base": base}


def test_a_reader_that_begins_anew_gets_everything_also_of_the_frame_that_it_has() -> None:
    feed = started()
    reader = FrameReader(feed)
    reader.take()
    feed.publish(frame(2))
    reader.take()

    reader.begin_anew()

    newest, skipped = taken(reader)
    assert (newest.seq, newest.full, skipped) == (2, True, 0)


def test_a_reader_that_caught_up_is_in_step_again() -> None:
    feed = started()
    reader = FrameReader(feed)
    reader.take()
    for seq in (2, 3, 4):
        feed.publish(frame(seq))
    reader.take()

    feed.publish(frame(5))

    newest, skipped = taken(reader)
    assert (newest.seq, newest.full, skipped) == (5, False, 0)


def test_a_slow_reader_makes_no_frame_larger_for_the_others() -> None:
    feed = started()
    slow, quick = FrameReader(feed), FrameReader(feed)
    slow.take()
    quick.take()
    feed.publish(frame(2))
    quick.take()
    feed.publish(frame(3))

    assert taken(slow)[0].full
    assert not taken(quick)[0].full


def test_all_who_need_everything_share_one_frame() -> None:
    feed = started()
    feed.publish(frame(2))

    assert taken(FrameReader(feed))[0] is taken(FrameReader(feed))[0]


def test_a_frame_that_was_handed_out_does_not_change_any_more() -> None:
    feed = started()
    feed.publish(frame(2))
    before, _ = taken(FrameReader(feed))

    feed.publish(frame(3, [part_view("arm", "STRONG")]))

    assert before.parts[ARM.name] is ARM


def test_nobody_gets_half_a_robot_before_the_first_full_frame() -> None:
    feed = FrameFeed()
    reader = FrameReader(feed)
    feed.publish(frame(1, [ARM]))

    assert feed.wants_full
    assert reader.take() is None

    feed.publish(frame(2, [ARM, DRIVE], [BATTERY], full=True))

    assert not feed.wants_full
    assert taken(reader)[0].seq == 2


def test_a_reader_is_woken_by_each_frame() -> None:
    feed, wakes = FrameFeed(), list[None]()

    with feed.watch(lambda: wakes.append(None)):
        feed.publish(frame(1, full=True))
        feed.publish(frame(2))

    assert len(wakes) == 2


def test_the_feed_says_what_is_newest() -> None:
    feed = FrameFeed()
    assert feed.newest is None

    feed.publish(frame(1, full=True))

    assert feed.newest == frame(1, full=True)


class Published:
    """Every frame of a live robot."""

    def __init__(self, feed: FrameFeed) -> None:
        self._feed = feed
        self.frames: list[Frame] = []

    def __call__(self) -> None:
        assert self._feed.newest is not None
        self.frames.append(self._feed.newest)


async def test_a_hold_is_in_the_next_frame_and_not_told_again_while_it_stays() -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    published = Published(supervisor.frames)
    async with running(supervisor):
        await clock.advance(0.1)
        with supervisor.frames.watch(published):
            supervisor.submit(HoldRequest("operator", "lunch", Actor("http:1")))
            await clock.advance(0.2)
            supervisor.submit(ReleaseRequest("operator", Actor("http:1")))
            await clock.advance(0.1)

    told = [f.holds for f in published.frames if f.holds_changed]
    assert [list(holds) for holds in told] == [["operator"], []]
    assert published.frames[0].holds_changed
    assert all("operator" in f.holds for f in published.frames[:4])


async def test_the_emergency_stop_is_in_the_frame_that_its_error_publishes_at_once() -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        await clock.advance(0.1)
        supervisor.submit(EmergencyStopRequest(engaged=True, reason="smoke", actor=Actor("anna")))

        newest = supervisor.frames.newest
        assert newest is not None
        assert newest.at == clock.now()
        assert newest.emergency_stop_changed
        assert (newest.emergency_stop.engaged, newest.emergency_stop.reason) == (True, "smoke")
        assert newest.holds_changed
        assert list(newest.holds) == ["error"]


async def test_a_task_that_ended_stays_until_the_next_one() -> None:
    clock = ManualClock()
    supervisor = make_supervisor(clock)
    async with running(supervisor):
        await clock.advance(0.1)
        before = supervisor.frames.complete()
        supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        supervisor.submit(CancelTaskRequest(Actor("http:1")))
        await clock.advance(2)
        ended = supervisor.frames.complete()
        supervisor.submit(TaskRequest(straight(), 0, "stanley", 2.8))
        await clock.advance(0.1)
        following = supervisor.frames.complete()

    assert before is not None
    assert before.task is None
    assert ended is not None
    assert ended.task is not None
    assert (ended.task.id, ended.task.status) == ("t1", TaskPhase.CANCELED)
    assert (ended.task.reason, ended.task.ended_at is None) == ("canceled", False)
    assert following is not None
    assert following.task is not None
    assert (following.task.id, following.task.ended_at) == ("t2", None)


def test_of_a_large_robot_a_reader_that_missed_frames_gets_what_changed_since() -> None:
    """A complete frame would take so long that the next ones are missed as well."""
    names = [PartName(f"node_{number}") for number in range(LARGE + 1)]
    feed = FrameFeed()
    feed.publish(frame(1, [part_view(name) for name in names], [BATTERY], full=True))
    reader, moved = FrameReader(feed), [part_view(name, "FAST") for name in names[:4]]
    reader.take()
    feed.publish(frame(2, moved[:2]))
    taken(reader)
    feed.publish(frame(3, [moved[2]]))
    # A complete frame that was missed changes a part, too.
    feed.publish(frame(4, [*moved, *(feed.parts[name] for name in names[4:])], full=True))
    feed.publish(frame(5))

    newest, skipped = taken(reader)

    assert (newest.seq, newest.full, skipped) == (5, False, 2)
    assert set(newest.parts.values()) == set(moved[2:])
    assert newest.signals == {"battery_level": BATTERY}
    assert newest.task_changed
    assert newest.vehicle_changed
    assert newest.holds_changed
    assert newest.emergency_stop_changed
    assert taken(FrameReader(feed))[0].parts.keys() == set(names)


@given(st.data())
def test_who_merges_what_it_is_told_has_all_parts_whatever_it_missed(data: st.DataObject) -> None:
    names = [PartName(f"node_{number}") for number in range(LARGE + 5)]
    feed, held = FrameFeed(), dict[PartName, PartView]()
    now = {name: part_view(name) for name in names}
    feed.publish(frame(1, list(now.values()), full=True))
    reader = FrameReader(feed)
    held.update(taken(reader)[0].parts)
    for seq in range(2, 12):
        changed = data.draw(st.sets(st.sampled_from(names[:6])))
        now |= {name: part_view(name, f"MODE_{seq}") for name in changed}
        full = data.draw(st.booleans())
        told = now if full else {name: now[name] for name in changed}
        feed.publish(frame(seq, list(told.values()), full=full))
        if data.draw(st.booleans()):
            held.update(taken(reader)[0].parts)
            assert held == now


# --- errors --------------------------------------------------------------------------------------

LOST = error_view("arm", "UNREACHABLE")
FOUND = error_view("arm", "UNREACHABLE", ErrorState.NORMAL)


def test_who_missed_the_end_of_an_error_learns_of_it_from_a_complete_frame() -> None:
    feed = FrameFeed()
    feed.publish(frame(1, [ARM], errors=[LOST], full=True))
    reader = FrameReader(feed)
    assert taken(reader)[0].errors == {"arm.UNREACHABLE": LOST}
    feed.publish(frame(2, errors=[FOUND]))
    feed.publish(frame(3))
    newest, skipped = taken(reader)
    assert (skipped, newest.full) == (1, True)
    assert newest.errors == {"arm.UNREACHABLE": FOUND}


def test_of_a_large_robot_only_the_errors_that_changed_since_are_told() -> None:
    feed = FrameFeed()
    parts = [part_view(f"node_{number}") for number in range(LARGE + 1)]
    low = error_view(None, "BATTERY_LOW")
    feed.publish(frame(1, parts, errors=[LOST, low], full=True))
    reader = FrameReader(feed)
    reader.take()
    feed.publish(frame(2, errors=[FOUND]))
    feed.publish(frame(3))
    newest, _ = taken(reader)
    assert (newest.full, newest.errors) == (False, {"arm.UNREACHABLE": FOUND})


@given(st.data())
def test_who_merges_what_it_is_told_has_all_errors_whatever_it_missed(data: st.DataObject) -> None:
    names = [f"node_{number}" for number in range(4)]
    parts = [part_view(f"node_{number}") for number in range(data.draw(st.sampled_from([1, 600])))]
    feed, held = FrameFeed(), dict[str, ErrorState]()
    now = {f"{name}.DEVIATES": error_view(name, "DEVIATES") for name in names}
    feed.publish(frame(1, parts, errors=list(now.values()), full=True))
    reader = FrameReader(feed)
    for seq in range(2, 12):
        changed = data.draw(st.sets(st.sampled_from(names)))
        state = data.draw(st.sampled_from(ErrorState))
        told = {f"{name}.DEVIATES": error_view(name, "DEVIATES", state) for name in changed}
        now |= told
        feed.publish(frame(seq, errors=list(told.values())))
        if data.draw(st.booleans()):
            held |= {name: view.state for name, view in taken(reader)[0].errors.items()}
            assert held == {name: view.state for name, view in now.items()}


def test_an_error_that_ended_long_ago_is_in_no_frame_any_more() -> None:
    feed = FrameFeed()
    feed.publish(frame(1, [ARM], errors=[LOST], full=True))
    feed.publish(frame(2, errors=[FOUND]))
    feed.publish(frame(1 + ENDED_KEPT))
    assert feed.errors == {"arm.UNREACHABLE": FOUND}
    feed.publish(frame(2 + ENDED_KEPT))
    assert feed.errors == {}
    complete = feed.complete()
    assert complete is not None
    assert complete.errors == {}


def test_an_error_that_came_back_is_not_forgotten() -> None:
    feed = FrameFeed()
    feed.publish(frame(1, [ARM], errors=[LOST], full=True))
    feed.publish(frame(2, errors=[FOUND]))
    feed.publish(frame(3, errors=[LOST]))
    feed.publish(frame(9 + ENDED_KEPT))
    assert feed.errors == {"arm.UNREACHABLE": LOST}
