import pytest

from domain.paths.path import Path
from domain.paths.preview import preview
from domain.simulation.vehicle_settings import VehicleSettings
from service.example_tracks import TRACKS, track_text
from service.files.waypoint_file import read_waypoints_csv
from tests.support.approach_limits import approach_limits


@pytest.mark.parametrize("name", TRACKS)
def test_each_track_is_one_that_the_vehicle_at_the_origin_can_drive(name: str) -> None:
    vehicle = VehicleSettings()
    path = Path(read_waypoints_csv(track_text(name)))
    found = preview(path, 2.8, vehicle.pose, approach_limits(vehicle.limits))

    assert found.warnings == ()
    assert found.start is not None
    assert found.start.distance_m < 1.0
    assert abs(found.start.heading_error_rad) < 0.1


def test_the_loop_is_as_long_as_its_title_says() -> None:
    assert TRACKS["loop"] == "A loop of 800 m"
    assert Path(read_waypoints_csv(track_text("loop"))).length_m == pytest.approx(800, abs=25)


@pytest.mark.parametrize(
    "name", ["", "actuation", "../example/loop", "loop.csv", "/etc/passwd", "LOOP", "loop\x00"]
)
def test_what_is_no_name_of_a_track_opens_no_file(name: str) -> None:
    with pytest.raises(KeyError):
        track_text(name)
