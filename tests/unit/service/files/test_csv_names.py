"""What names of columns say."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.files.csv_names import Meaning, column_name

NAMES = {
    Meaning.X: "x X x_m X[m] x(m) X-m pos_x PosX posX tx cx p_RS_R_x pose.position.x /odom/x x_km"
    " field.pose.pose.position.x x_ref_m Easting utm_x x_racetraj_m",
    Meaning.Y: "y y_m position_y Northing map.y",
    Meaning.YAW: "yaw Heading theta psi psi_rad yaw_deg heading_deg Yaw[°] course psi_racetraj_rad"
    " heading_compass pose.yaw YAW vehicle_heading",
    Meaning.QX: "qx q_x orientation.x",
    Meaning.QY: "qy quaternion_y",
    Meaning.QZ: "qz pose.orientation.z rotation.z",
    Meaning.QW: "qw q_RS_w field.pose.pose.orientation.w",
    Meaning.TIME: "t time stamp timestamp %time field.header.stamp timestamp[ns] time_s",
    Meaning.HEIGHT: "z altitude pose.position.z",
    Meaning.DISTANCE: "s s_m distance s_racetraj_m",
    Meaning.SPEED: "v vx_mps speed velocity v_RS_R_x[ms^-1]",
    Meaning.ACCELERATION: "ax_mps2",
    Meaning.CURVATURE: "kappa kappa_radpm curvature",
    Meaning.WIDTH: "w_tr_right_m width_left_m",
    Meaning.LATITUDE: "lat Latitude gps_lat",
    Meaning.LONGITUDE: "lon lng longitude",
    Meaning.OTHER: "- _ yaw_rate x_normvec_m twist.linear.x steering_angle dx"
    " yaw_rate_radps change_flag b_w_RS_S_x angular.z x_mps covariance.0",
}
CASES = [(name, meaning) for meaning, names in NAMES.items() for name in names.split()]


@pytest.mark.parametrize(("name", "meaning"), CASES)
def test_names_of_the_field_are_known(name: str, meaning: Meaning) -> None:
    assert column_name(name).meaning is meaning


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("x", None),
        ("x_m", "m"),
        ("X [m]", "m"),
        ("x_km", "km"),
        ("yaw (deg)", "deg"),
        ("psi_rad", "rad"),
        ("heading_compass", "compass"),
        ("Yaw [°]", "deg"),
        ("ax_mps2", "mps2"),
        ("q_RS_w []", None),
        ("s", None),
    ],
)
def test_units_are_read_from_names(name: str, unit: str | None) -> None:
    assert column_name(name).unit == unit


def test_a_plain_name_comes_before_a_known_context_and_that_before_any_other() -> None:
    assert [column_name(name).rank for name in ("x_m", "pose.x", "left_x")] == [0, 1, 2]


@given(st.text(max_size=80))
def test_any_text_is_some_name(text: str) -> None:
    assert column_name(text).meaning in Meaning
