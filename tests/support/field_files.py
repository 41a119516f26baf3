"""Waypoint files as public recorders, planners and spreadsheets write them.

Each kind has the layout of one of them: separator, header, order of columns, decimals, line ends.
The path is made by formula; what is published elsewhere is not copied.
"""

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

COUNT = 121
SPEED_MPS = 2.5
_UTM = (303628.0, 3900696.0)


class Track:
    """A bent loop that comes back to within 5 m of where it began.

    Args:
        scale: Size; 1: some 130 m around.
    """

    def __init__(self, scale: float = 1.0) -> None:
        at = np.linspace(0.3, 0.3 + 1.9 * math.pi, COUNT)
        radius = 20 * scale * (1 + 0.25 * np.sin(2 * at))
        slope = 20 * scale * 0.5 * np.cos(2 * at)
        self.x = radius * np.cos(at) - radius[0] * math.cos(at[0])
        self.y = radius * np.sin(at) - radius[0] * math.sin(at[0])
        self.yaw = _wrapped(
            np.arctan2(
                slope * np.sin(at) + radius * np.cos(at), slope * np.cos(at) - radius * np.sin(at)
            )
        )
        steps = np.hypot(np.diff(self.x), np.diff(self.y))
        self.s = np.concatenate(([0.0], np.cumsum(steps)))
        self.t = self.s / SPEED_MPS
        self.one = np.ones(COUNT)
        self.zero = np.zeros(COUNT)

    @property
    def places(self) -> Floats:
        """Return positions of the waypoints, shape (n, 2), m."""
        return np.column_stack((self.x, self.y))

    @property
    def compass(self) -> Floats:
        """Return headings in degrees clockwise from north, 0 to 360."""
        return np.asarray((90 - np.degrees(self.yaw)) % 360)

    @property
    def psi(self) -> Floats:
        """Return headings in rad counter-clockwise from north."""
        return _wrapped(self.yaw - math.pi / 2)

    @property
    def speed(self) -> Floats:
        """Return speeds, m/s."""
        return SPEED_MPS + np.sin(self.s / 10)

    @property
    def quaternion(self) -> tuple[Floats, ...]:
        """Return x, y, z and w of the rotations."""
        return self.zero, self.zero, np.sin(self.yaw / 2), np.cos(self.yaw / 2)


def _wrapped(angles: Floats) -> Floats:
    return np.asarray((angles + math.pi) % math.tau - math.pi)


def rows(
    columns: Sequence[Floats], separator: str = ",", form: str = "%.4f", end: str = "\n"
) -> str:
    """Return the lines of some columns."""
    table = np.column_stack(columns)
    return "".join(separator.join(form % value for value in row) + end for row in table.tolist())


def _line(cells: Iterable[str], separator: str = ",") -> str:
    return separator.join(cells) + "\n"


# --- planners ------------------------------------------------------------------------------------


def racetrack_centre_line() -> str:
    """Centre line with widths, named in a comment; no headings."""
    track = Track()
    names = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n"
    return names + rows((track.x, track.y, 5.5 * track.one, 5.2 * track.one), form="%.6f")


def racetrack_race_line() -> str:
    """Race line with semicolons below three comments; psi counts from north."""
    track = Track()
    columns = (track.s, track.x, track.y, track.psi, track.zero, track.speed, track.zero)
    return "# 5f4c2a\n# 8d1e\n# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n" + rows(
        columns, "; ", "%.7f"
    )


def reference_with_normals() -> str:
    """Reference line, its normals, and the race line beside it."""
    track = Track()
    names = (
        "# x_ref_m; y_ref_m; width_right_m; width_left_m; x_normvec_m; y_normvec_m; alpha_m;"
        " s_racetraj_m; psi_racetraj_rad; kappa_racetraj_radpm; vx_racetraj_mps; ax_racetraj_mps2\n"
    )
    normals = (np.sin(track.yaw), -np.cos(track.yaw))
    widths = (4 * track.one, 4 * track.one)
    rest = (track.s, track.psi, track.zero, track.speed, track.zero)
    return names + rows((track.x, track.y, *widths, *normals, track.zero, *rest), ";")


def small_centre_line() -> str:
    """Centre line of a 1:10 car: x, y and widths with blanks after the commas."""
    track = Track(0.2)
    columns = (track.x, track.y, 1.1 * track.one, 1.1 * track.one)
    return "# x_m, y_m, w_tr_right_m, w_tr_left_m\n" + rows(columns, ", ")


def race_line_without_names() -> str:
    """Race line with semicolons, whose columns are known from elsewhere: s, x, y, psi, ..."""
    track = Track(0.2)
    columns = (track.s, track.x, track.y, track.psi, track.zero, track.speed, track.zero)
    return rows(columns, ";")


def planner_trajectory() -> str:
    """Waypoints with heights, speeds and flags below a header."""
    track = Track()
    names = "x,y,z,yaw,velocity,change_flag\n"
    return names + rows((track.x, track.y, 36 * track.one, track.yaw, track.speed, track.zero))


def highway_map() -> str:
    """Map of a highway: x y s dx dy, with blanks and without a header."""
    track = Track()
    return rows((track.x, track.y, track.s, np.sin(track.yaw), -np.cos(track.yaw)), " ", "%g")


def highway_map_with_names() -> str:
    """The same with its names."""
    return "x y s dx dy\n" + highway_map()


def places_only() -> str:
    """x and y, and nothing else."""
    track = Track()
    return rows((track.x, track.y))


def course_of_a_tutorial() -> str:
    """cx and cy, as pure pursuit tutorials have them."""
    return "cx,cy\n" + places_only()


# --- recorders -----------------------------------------------------------------------------------


def recorded_radians() -> str:
    """x, y, yaw and speed, as recorders of pure pursuit write them."""
    track = Track()
    return rows((track.x, track.y, track.yaw, track.speed))


def recorded_degrees() -> str:
    """x, y, yaw in degrees."""
    track = Track()
    return rows((track.x, track.y, np.degrees(track.yaw)))


def recorded_compass() -> str:
    """x, y and the heading of a GNSS receiver."""
    track = Track()
    return rows((track.x, track.y, track.compass))


def named_compass() -> str:
    """Heading in degrees, of which the name does not say where it is 0."""
    track = Track()
    return "X [m],Y [m],heading_deg\n" + rows((track.x, track.y, track.compass))


def recorded_in_reverse() -> str:
    """x, y and yaw of a vehicle that drove backwards."""
    track = Track()
    return rows((track.x, track.y, _wrapped(track.yaw + math.pi)))


def topic_as_csv() -> str:
    """An odometry topic printed as CSV."""
    track = Track()
    pose = "field.pose.pose"
    names = [
        "%time",
        "field.header.seq",
        "field.header.frame_id",
        *(f"{pose}.position.{axis}" for axis in "xyz"),
        *(f"{pose}.orientation.{axis}" for axis in "xyzw"),
        "field.pose.covariance0",
        "field.twist.twist.linear.x",
        "field.twist.twist.angular.z",
    ]
    stamps = 1_305_031_102_175_800_000 + (track.t * 1e9).astype(int)
    numbers = np.column_stack(
        (track.x, track.y, track.zero, *track.quaternion, track.zero, track.speed, track.zero)
    ).tolist()
    lines = (
        _line([str(stamp), str(index), "odom", *(f"{value:.6f}" for value in row)])
        for index, (stamp, row) in enumerate(zip(stamps.tolist(), numbers, strict=True))
    )
    return _line(names) + "".join(lines)


def poses_as_csv() -> str:
    """Poses with quoted names."""
    track = Track()
    names = ["stamp", *(f"pose.position.{axis}" for axis in "xyz")]
    names += [f"pose.orientation.{axis}" for axis in "xyzw"]
    columns = (track.t, track.x, track.y, track.zero, *track.quaternion)
    return _line(f'"{name}"' for name in names) + rows(columns)


def slam_trajectory() -> str:
    """timestamp tx ty tz qx qy qz qw with blanks, named in the last of three comments."""
    names = "# ground truth\n# file: 'loop.bag'\n# timestamp tx ty tz qx qy qz qw\n"
    return names + slam_trajectory_without_names()


def slam_trajectory_without_names() -> str:
    """The same without the comments."""
    track = Track()
    columns = (1_305_031_102.1758 + track.t, track.x, track.y, track.zero, *track.quaternion)
    return rows(columns, " ")


def flight_state() -> str:
    """State estimate of a data set of flights: units in brackets, velocities and biases."""
    track = Track()
    names = (
        "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [],"
        " q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], b_w_RS_S_x [rad s^-1]\n"
    )
    qx, qy, qz, qw = track.quaternion
    speeds = (track.speed, track.zero, track.zero)
    stamps = 1_403_636_579_758_555_392 + 1e9 * track.t
    return names + rows((stamps, track.x, track.y, track.zero, qw, qx, qy, qz, *speeds))


def matrix_poses() -> str:
    """Poses as 3x4 matrices, 12 numbers a line."""
    track = Track()
    cos, sin = np.cos(track.yaw), np.sin(track.yaw)
    first = (cos, track.zero, sin, track.x)
    last = (-sin, track.zero, cos, track.y)
    return rows((*first, track.zero, track.one, track.zero, track.zero, *last), " ", "%.6e")


# --- spreadsheets and others ---------------------------------------------------------------------


def tabs() -> str:
    """Export with tabs."""
    track = Track()
    return "x\ty\ttheta\n" + rows((track.x, track.y, track.yaw), "\t", "%.15g")


def spreadsheet() -> str:
    """Semicolons and decimal commas, a byte order mark, CRLF."""
    track = Track()
    text = rows((track.x, track.y, np.degrees(track.yaw)), ";", end="\r\n").replace(".", ",")
    return "\ufeffX;Y;Yaw [°]\r\n" + text


def old_macintosh() -> str:
    """Lines that end with CR."""
    return recorded_radians().replace("\n", "\r")


def quoted() -> str:
    """Everything in quotes, and a comma after the last column."""
    track = Track()
    table = np.column_stack((track.x, track.y, track.yaw)).tolist()
    lines = ("".join(f'"{value:.4f}",' for value in row) + "\n" for row in table)
    return '"X","Y","YAW",\n' + "".join(lines)


def exponents() -> str:
    """Numbers as numpy saves them, in the order yaw, y, x."""
    track = Track()
    return "# yaw y x\n" + rows((track.yaw, track.y, track.x), " ", "%.18e")


def distances_first() -> str:
    """s, x, y without a header."""
    track = Track()
    return rows((track.s, track.x, track.y))


def small_distances_first() -> str:
    """The same in a yard of 6 m, where y is a heading of a few degrees at any rate."""
    track = Track(0.1)
    return rows((track.s, track.x, track.y))


def counts_first() -> str:
    """Index, x, y without a header, as data frames are saved."""
    track = Track(0.2)
    return rows((np.arange(float(COUNT)), track.x, track.y))


def times_first() -> str:
    """Seconds since the start, x, y without a header."""
    track = Track()
    return rows((track.t, track.x, track.y))


def widths() -> str:
    """x, y and a width without a header."""
    track = Track()
    return rows((track.x, track.y, 1.1 * track.one))


def speeds() -> str:
    """x, y and a speed without a header."""
    track = Track()
    return rows((track.x, track.y, track.speed))


def times() -> str:
    """x, y and seconds since 1970 without a header."""
    track = Track()
    return rows((track.x, track.y, 1_600_000_000 + track.t))


def utm() -> str:
    """UTM coordinates, m from the equator."""
    track = Track()
    return rows((_UTM[0] + track.x, _UTM[1] + track.y, track.yaw), form="%.3f")


def named_degrees_of_latitude() -> str:
    """Latitude and longitude below a header."""
    return "lat,lon\n" + degrees_of_latitude()


def degrees_of_latitude() -> str:
    """Latitude and longitude without a header."""
    track = Track()
    return rows((40.093 + track.y / 111_000, -88.2357 + track.x / 85_000), form="%.8f")


def no_headings_recorded() -> str:
    """x, y and a yaw that is 0 everywhere."""
    track = Track()
    return rows((track.x, track.y, track.zero))


FIELD_FILES: tuple[Callable[[], str], ...] = (
    racetrack_centre_line,
    racetrack_race_line,
    reference_with_normals,
    small_centre_line,
    race_line_without_names,
    planner_trajectory,
    highway_map,
    highway_map_with_names,
    places_only,
    course_of_a_tutorial,
    recorded_radians,
    recorded_degrees,
    recorded_compass,
    named_compass,
    recorded_in_reverse,
    topic_as_csv,
    poses_as_csv,
    slam_trajectory,
    slam_trajectory_without_names,
    flight_state,
    matrix_poses,
    tabs,
    spreadsheet,
    old_macintosh,
    quoted,
    exponents,
    distances_first,
    small_distances_first,
    counts_first,
    times_first,
    widths,
    speeds,
    times,
    utm,
    named_degrees_of_latitude,
    degrees_of_latitude,
    no_headings_recorded,
)
