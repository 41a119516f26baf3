import pickle
from pathlib import Path as FilePath

import pytest

from domain.errors import InvalidValueError
from domain.paths.waypoints import MAX_WAYPOINTS
from service.files.csv_table import InvalidWaypointsError
from service.files.waypoint_folder import WaypointFolder
from service.ros.interface.waypoint_jobs import check_count, read_track, rows_of


def point(**more: object) -> dict[str, object]:
    return {"x_m": 1.0, "y_m": 2, "yaw_rad": 0.0, **more}


def test_the_path_and_the_warnings_of_a_file_are_read(tmp_path: FilePath) -> None:
    (tmp_path / "back.csv").write_text("0,0,3.14159\n5,0,3.14159\n9,0,3.14159\n")

    track = pickle.loads(pickle.dumps(read_track(WaypointFolder(tmp_path), "back.csv")))

    assert track.path.count == 3
    assert ["reversed" in warning for warning in track.warnings] == [True]


def test_a_file_whose_columns_are_not_clear_is_rejected(tmp_path: FilePath) -> None:
    (tmp_path / "odd.csv").write_text("0,0,45\n5,0,45\n9,0,45\n")

    with pytest.raises(InvalidWaypointsError, match="in no unit"):
        read_track(WaypointFolder(tmp_path), "odd.csv")


def test_waypoints_of_a_message_become_rows() -> None:
    assert rows_of([point(), point(x_m=4)]).tolist() == [[1.0, 2.0, 0.0], [4.0, 2.0, 0.0]]


def test_no_waypoints_are_no_rows() -> None:
    assert rows_of([]).shape == (0, 3)


@pytest.mark.parametrize(
    ("waypoints", "pointer"),
    [
        ([point(), 7], "waypoints/1"),
        ([point(), {"x_m": 1.0, "yaw_rad": 0.0}], "waypoints/1/y_m"),
        ([point(), point(z_m=0.0)], "waypoints/1/z_m"),
        ([point(), point(x_m="4")], "waypoints/1/x_m"),
        ([point(), point(x_m=10**400)], "waypoints/1/x_m"),
    ],
)
def test_what_is_no_waypoint_is_rejected_with_its_place(
    waypoints: list[object], pointer: str
) -> None:
    with pytest.raises(InvalidValueError) as caught:
        rows_of(waypoints)

    assert caught.value.pointer == pointer


def test_too_many_waypoints_are_rejected_before_any_is_read() -> None:
    check_count([None] * MAX_WAYPOINTS)

    with pytest.raises(InvalidValueError, match="2 to 100000 waypoints, not 100001"):
        check_count([None] * (MAX_WAYPOINTS + 1))
