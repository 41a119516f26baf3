"""The checkpoints of one node, as its programmer has them supervised."""

from domain.health.checkpoints import (
    AliveLimits,
    CheckpointDeadline,
    CheckpointSettings,
    NodeCheckpoints,
)
from domain.timebase import seconds

FEW, MANY = "CHECKPOINT_TOO_FEW", "CHECKPOINT_TOO_MANY"
LATE, ORDER = "CHECKPOINT_LATE", "CHECKPOINT_WRONG_ORDER"


class Program:
    """A node that reaches checkpoints, and the errors that follow."""

    def __init__(self, settings: CheckpointSettings, *, is_active: bool = True) -> None:
        self.now = 0
        self.checkpoints = NodeCheckpoints(settings)
        self.on: dict[str, str] = {}
        """Errors with their messages."""
        self.told: list[tuple[float, str, bool]] = []
        """What was raised (True) or cleared, with the time in s."""
        if is_active:
            self.checkpoints.begin(0)
        self._judge()

    def reach(self, *names: str, is_late: bool = False) -> None:
        for name in names:
            self.checkpoints.reach(name, self.now, is_late=is_late)
            self._judge(is_late=is_late)

    def run(self, name: str, every_s: float, times: int) -> None:
        """Reach a checkpoint again and again, and wait each time."""
        for _ in range(times):
            self.reach(name)
            self.wait(every_s)

    def wait(self, duration_s: float) -> None:
        end = self.now + seconds(duration_s)
        while (due := self.checkpoints.wake_at()) is not None and due <= end:
            self.now = due
            self._judge()
        self.now = end

    def end(self) -> None:
        self.checkpoints.end(self.now)
        self._judge()

    def pause(self) -> None:
        self.checkpoints.pause()
        self._judge()

    def begin(self) -> None:
        self.checkpoints.begin(self.now)
        self._judge()

    def _judge(self, *, is_late: bool = False) -> None:
        for error, problem in self.checkpoints.judge(self.now, is_late=is_late).items():
            self.told.append((round(self.now / 1e9, 3), error, problem is not None))
            if problem is None:
                del self.on[error]
            else:
                self.on[error] = problem.message


def alive(at_least: int = 0, at_most: int | None = None) -> CheckpointSettings:
    """Return limits for one second."""
    return CheckpointSettings((AliveLimits("cycle", seconds(1), at_least, at_most),))


def deadline(within_s: float = 0.2) -> CheckpointSettings:
    return CheckpointSettings(deadlines=(CheckpointDeadline("begin", "end", seconds(within_s)),))


CYCLE = CheckpointSettings(order={"sense": ("plan",), "plan": ("act", "stop"), "act": ("sense",)})


# --- alive ---------------------------------------------------------------------------------------


def test_a_program_within_its_limits_has_no_error() -> None:
    program = Program(alive(at_least=10, at_most=10))

    program.run("cycle", every_s=0.1, times=50)

    assert program.told == []


def test_a_program_that_hangs_is_reached_too_few_times() -> None:
    program = Program(alive(at_least=5))
    program.run("cycle", every_s=0.1, times=10)

    program.wait(5)

    # The fifth last was at 0.5 s.
    assert program.told == [(1.5, FEW, True)]
    (message,) = program.on.values()
    assert message == "cycle was reached 4 times in 1 s, and should have been at least 5 times"


def test_a_program_that_never_reaches_it_has_a_window_from_its_start() -> None:
    program = Program(alive(at_least=1))

    program.wait(1)
    assert program.on == {}
    program.wait(0.001)

    assert program.on == {FEW: "cycle was not reached in 1 s, and should have been at least once"}


def test_too_few_ends_once_all_has_been_well_for_a_second() -> None:
    program = Program(alive(at_least=2))
    program.wait(3)

    program.run("cycle", every_s=0.4, times=6)

    assert program.told == [(1.0, FEW, True), (4.4, FEW, False)]


def test_a_program_in_a_tight_loop_is_reached_too_many_times() -> None:
    program = Program(alive(at_most=3))

    program.run("cycle", every_s=0.1, times=4)
    program.wait(5)

    assert program.told == [(0.3, MANY, True), (2.0, MANY, False)]


def test_checkpoints_that_waited_for_us_are_not_too_many() -> None:
    program = Program(alive(at_least=8, at_most=12))
    program.run("cycle", every_s=0.1, times=10)
    program.now += seconds(3)  # The service hangs, and the node does not.

    program.reach(*["cycle"] * 30, is_late=True)
    program.run("cycle", every_s=0.1, times=10)

    assert program.told == []


# --- deadline ------------------------------------------------------------------------------------


def test_a_step_that_ends_in_time_is_no_error() -> None:
    program = Program(deadline(0.2))

    program.reach("begin")
    program.wait(0.2)
    program.reach("end")
    program.wait(10)

    assert program.told == []


def test_a_step_that_never_ends_is_late_when_its_time_is_up() -> None:
    program = Program(deadline(0.2))

    program.reach("begin")
    program.wait(10)

    assert program.told == [(0.2, LATE, True)]
    assert program.on[LATE] == "end was not reached within 0.2 s of begin"


def test_a_step_that_hangs_is_late_however_often_it_is_begun() -> None:
    program = Program(deadline(0.2))

    program.run("begin", every_s=0.1, times=4)

    assert program.told == [(0.2, LATE, True)]


def test_a_late_step_is_told_until_one_ends_in_time() -> None:
    program = Program(deadline(0.2))
    program.reach("begin")
    program.wait(0.5)
    program.reach("end")
    program.wait(5)
    assert list(program.on) == [LATE]

    program.reach("begin", "end")
    program.wait(5)

    assert program.told[1:] == [(6.5, LATE, False)]


def test_an_end_without_a_beginning_is_no_error() -> None:
    program = Program(deadline())

    program.reach("end", "end")
    program.wait(5)

    assert program.told == []


def test_an_end_that_waited_for_us_is_in_time() -> None:
    program = Program(deadline(0.2))
    program.reach("begin")
    program.now += seconds(3)

    program.reach("end", is_late=True)
    program.wait(5)

    assert program.told == []


# --- order ---------------------------------------------------------------------------------------


def test_a_program_in_its_order_has_no_error_wherever_it_is_met_first() -> None:
    program = Program(CYCLE)

    program.reach("plan", "act", "sense", "plan", "act", "sense")

    assert program.told == []


def test_a_step_that_is_left_out_is_told() -> None:
    program = Program(CYCLE)

    program.reach("sense", "act")

    assert program.on == {ORDER: "act was reached after sense, and plan should have been"}


def test_nothing_may_follow_what_has_no_successor() -> None:
    program = Program(CYCLE)

    program.reach("plan", "stop", "sense")

    assert program.on == {ORDER: "sense was reached after stop, and nothing should have been"}


def test_wrong_order_ends_once_it_was_right_for_a_second() -> None:
    program = Program(CYCLE)
    program.reach("sense", "act")
    program.wait(5)

    program.reach("sense")
    program.wait(5)

    assert program.told == [(0.0, ORDER, True), (6.0, ORDER, False)]


def test_checkpoints_without_an_order_come_between_others() -> None:
    limits = (AliveLimits("cycle", seconds(1), 0, 100),)
    program = Program(CheckpointSettings(limits, order={"sense": ("act",)}))

    program.reach("sense", "cycle", "act")

    assert program.told == []


# --- when it is supervised -----------------------------------------------------------------------


def test_a_node_that_is_not_active_is_not_supervised() -> None:
    program = Program(alive(at_least=1), is_active=False)

    program.reach("cycle")
    program.wait(10)

    assert program.told == []


def test_errors_clear_when_the_node_is_deactivated() -> None:
    program = Program(alive(at_least=1))
    program.wait(3)

    program.end()
    program.wait(10)

    assert program.told == [(1.0, FEW, True), (3.0, FEW, False)]


def test_errors_stay_while_nothing_is_known_of_the_node() -> None:
    program = Program(alive(at_least=1))
    program.wait(3)

    program.pause()
    program.wait(10)

    assert list(program.on) == [FEW]


def test_supervision_begins_anew_when_the_node_is_back() -> None:
    program = Program(CYCLE)
    program.reach("sense", "act")
    program.pause()
    program.wait(5)

    program.begin()
    program.reach("plan")
    program.wait(2)

    assert program.told == [(0.0, ORDER, True), (6.0, ORDER, False)]


# --- several at once -----------------------------------------------------------------------------


def test_an_error_stays_until_its_last_cause_is_gone() -> None:
    limits = tuple(AliveLimits(name, seconds(1), 1) for name in ("left", "right"))
    program = Program(CheckpointSettings(limits))
    program.wait(2)
    assert program.on[FEW].startswith("left was")

    program.run("left", every_s=0.5, times=4)

    assert program.on[FEW].startswith("right was")
    assert [(error, is_raised) for _, error, is_raised in program.told] == [(FEW, True)] * 2


def test_errors_clear_at_once_where_that_is_set() -> None:
    program = Program(CheckpointSettings(order={"a": ("b",), "b": ("a",)}, clear_for=0))

    program.reach("a", "a", "b")

    assert program.told == [(0.0, ORDER, True), (0.0, ORDER, False)]


def test_a_node_has_the_checkpoints_that_any_of_its_settings_name() -> None:
    settings = CheckpointSettings(
        (AliveLimits("cycle", seconds(1), 1),),
        (CheckpointDeadline("begin", "end", seconds(1)),),
        {"begin": ("cycle", "done")},
    )

    assert settings.names == ("cycle", "begin", "end", "done")
