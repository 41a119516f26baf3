from domain.inputs import CancelTaskRequest, HoldRequest, ReleaseRequest, TaskRequest
from domain.tasks.drive_words import describe_drive_request
from tests.support.paths import straight


def test_a_task_is_recorded_by_what_it_is_and_not_by_all_its_waypoints() -> None:
    kind, data = describe_drive_request(TaskRequest(straight(), 2, "stanley", 2.8, "op"))

    assert kind == "task.requested"
    assert data == {
        "waypoints": 21,
        "length_m": 20.0,
        "start_index": 2,
        "controller": "stanley",
        "speed_mps": 2.8,
    }


def test_the_others_are_recorded_by_what_they_name() -> None:
    assert describe_drive_request(CancelTaskRequest()) == ("task.cancel_requested", {})
    assert describe_drive_request(HoldRequest("gate", "closed")) == (
        "hold.requested",
        {"owner": "gate", "reason": "closed"},
    )
    assert describe_drive_request(ReleaseRequest("gate")) == (
        "hold.release_requested",
        {"owner": "gate"},
    )
