import pytest
from pydantic_core import from_json, to_json

from api.http.schemas.simulation import SampleJson
from api.http.schemas.tasks import TaskJson, VehicleJson
from api.simulation import samples
from api.simulation.samples import Sampler
from domain.actor import Actor
from domain.inputs import CancelTaskRequest, HoldRequest, ReleaseRequest
from domain.timebase import seconds
from service.simulation.virtual_time import VirtualService
from service.worker import TooComplexError
from tests.support.scenarios import ALL_GOOD, STRAIGHT, answer, happened, scenario, virtual_robot


@pytest.fixture
def robot() -> VirtualService:
    return virtual_robot(scenario())


def test_a_sample_shows_all_there_is(robot: VirtualService) -> None:
    sample = from_json(Sampler(robot.supervisor).sample(0.5, 3))

    SampleJson.model_validate(sample)
    assert (sample["t_s"], sample["system_state"]["seq"]) == (0.5, 3)
    assert set(sample["parts"]) == {"actuation", "drive_base", "manipulator"}
    assert set(sample["parts"]["actuation"]) >= {
        "target",
        "effective_target",
        "actual",
        "converged",
    }
    assert sample["task"] is None
    assert sample["signals"]["battery_level"]["unit"] == "ratio"
    assert sample["emergency_stop"]["engaged"] is False
    assert all(error["state"] != "normal" for error in sample["errors"].values())


def test_holds_are_shown_by_owner(robot: VirtualService) -> None:
    robot.supervisor.submit(HoldRequest("operator", "lunch", Actor("test")))

    sample = from_json(Sampler(robot.supervisor).sample(0, 0))

    assert sample["holds"]["operator"]["reason"] == "lunch"


def test_a_task_that_ended_is_no_current_one_any_more() -> None:
    told = answer(
        happened(
            ALL_GOOD,
            {"t_s": 1, "task": {"waypoints": STRAIGHT}},
            {"t_s": 2, "task": None},
            until_s=3,
        )
    )

    assert told["samples"][-1]["task"] is None


def test_a_sample_shows_what_has_changed_since_the_one_before(robot: VirtualService) -> None:
    sampler = Sampler(robot.supervisor)
    before = from_json(sampler.sample(0, 0))
    robot.advance_to(seconds(1))
    after = from_json(sampler.sample(1, 1))

    assert before["parts"]["drive_base"]["actual"]["state"] == "unknown"
    assert after["parts"]["drive_base"]["actual"]["state"] == "unconfigured"


def test_task_and_vehicle_are_as_in_their_get() -> None:
    told = answer(happened(ALL_GOOD, {"t_s": 1, "task": {"waypoints": STRAIGHT}}, until_s=2))
    sample = told["samples"][-1]

    assert TaskJson.model_validate_json(to_json(sample["task"])).status == "RUNNING"
    assert VehicleJson.model_validate_json(to_json(sample["vehicle"])).command.speed_mps > 0


def test_events_are_collected_and_counted_by_kind(robot: VirtualService) -> None:
    sampler = Sampler(robot.supervisor)
    robot.advance_to(seconds(1))
    robot.supervisor.submit(HoldRequest("operator", "lunch", Actor("test")))
    robot.supervisor.submit(ReleaseRequest("operator", Actor("test")))
    robot.supervisor.submit(CancelTaskRequest(Actor("test")))
    sampler.collect_events()

    assert (sampler.counts()["hold.set"], sampler.counts()["task.served"]) == (1, 0)
    told = [from_json(text) for text in sampler.event_texts()]
    assert [event["kind"] for event in told].count("hold.set") == 1
    assert told[0]["epoch"] == "simulation"


def test_more_events_than_can_be_told_are_too_complex(
    robot: VirtualService, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(samples, "MAX_EVENTS", 2)
    sampler = Sampler(robot.supervisor)
    robot.advance_to(seconds(1))

    with pytest.raises(TooComplexError, match="more than 2 events"):
        sampler.collect_events()


def test_events_that_the_log_has_forgotten_are_not_left_out_in_silence(
    robot: VirtualService,
) -> None:
    sampler = Sampler(robot.supervisor)
    for _ in range(3_000):
        robot.supervisor.submit(HoldRequest("operator", "lunch", Actor("test")))
        robot.supervisor.submit(ReleaseRequest("operator", Actor("test")))

    with pytest.raises(TooComplexError, match="too many events"):
        sampler.collect_events()


def test_samples_that_are_too_long_together_are_too_complex(
    robot: VirtualService, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(samples, "MAX_CHARACTERS", len(Sampler(robot.supervisor).sample(0, 0)) + 1)
    sampler = Sampler(robot.supervisor)

    sampler.kept_sample(0, 0)

    with pytest.raises(TooComplexError, match="sample less often"):
        sampler.kept_sample(1, 1)
