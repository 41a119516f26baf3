"""What the name of one column says: its meaning, and its unit.

Names are those of the field, such as `x`, `x_m`, `X [m]`, `pose.position.x`, `psi_rad`, `qz`.
"""

import re
from dataclasses import dataclass
from enum import StrEnum


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_AXES = "xyzw"
_X = _words("x tx px cx posx xpos easting east")
_Y = _words("y ty py cy posy ypos northing north")
_PLACES = _words(
    "pose position pos point points translation location coordinate coordinates field map utm local"
    " world enu odom odometry waypoint waypoints wp path target ref reference center centre"
    " centerline line raceline racetraj traj trajectory p m base link transform"
)
_ROTATIONS = _words("q quat quaternion orientation ori rotation rot attitude")
_HEADINGS = _words("yaw heading theta psi hdg bearing course azimuth cog")
_LONE_HEADINGS = _words("th angle orientation direction phi")
_OTHERS = _words(
    "v b a w twist linear angular velocity vel speed acc accel acceleration normvec normal norm cov"
    " covariance std sigma var variance err error rate dot omega steering steer gyro mag force"
    " torque gravity bias"
)
"""Words that make an axis or an angle something else: `linear.x`, `yaw_rate`."""

_METRES = _words("m meter meters metre metres")
_OTHER_LENGTHS = _words("km cm mm ft feet inch px pixel pixels deg degree degrees rad")
_RADIANS = _words("rad rads radian radians")
_DEGREES = _words("deg degs degree degrees")
_MORE_UNITS = _words("s sec secs ms us ns nsec mps radpm radps mps2 kmh kph mph")
_UNITS = _METRES | _OTHER_LENGTHS | _RADIANS | _DEGREES | _MORE_UNITS | {"compass"}

_BRACKETS = re.compile(r"[\[(]([^\])]*)[\])]")
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


class Meaning(StrEnum):
    """What a column holds."""

    X = "x"
    Y = "y"
    YAW = "yaw"
    QX = "qx"
    QY = "qy"
    QZ = "qz"
    QW = "qw"
    LATITUDE = "latitude"
    LONGITUDE = "longitude"
    TIME = "time"
    HEIGHT = "height"
    DISTANCE = "distance"
    SPEED = "speed"
    ACCELERATION = "acceleration"
    CURVATURE = "curvature"
    WIDTH = "width"
    OTHER = "other"


_LONE = {
    Meaning.TIME: "t time stamp timestamp ts sec secs nsec nsecs unix",
    Meaning.HEIGHT: "z tz pz alt altitude height elevation",
    Meaning.DISTANCE: "s distance dist station arclength",
    Meaning.SPEED: "v vx speed velocity vel",
    Meaning.ACCELERATION: "a ax acc accel acceleration",
    Meaning.CURVATURE: "k kappa curvature curv",
    Meaning.WIDTH: "width w tr",
    Meaning.LATITUDE: "lat latitude",
    Meaning.LONGITUDE: "lon lng long longitude",
}
_MEANING_OF = {word: meaning for meaning, words in _LONE.items() for word in words.split()}


@dataclass(frozen=True, slots=True)
class ColumnName:
    """What one name says."""

    meaning: Meaning
    context: tuple[str, ...] = ()
    """Further words, as `pose, position` of `pose.position.x`."""
    unit: str | None = None

    @property
    def rank(self) -> int:
        """Return 0 for a plain name, 1 for a known context, and 2 for any other."""
        return 0 if not self.context else 1 if _PLACES.issuperset(self.context) else 2


def column_name(name: str) -> ColumnName:
    """Return what a name says."""
    unit = None
    text = name.replace("°", " deg ")
    if found := _BRACKETS.search(text):
        unit = found[1].strip().lower() or None
        text = _BRACKETS.sub(" ", text)
    words = [word.lower() for word in _WORD.findall(text)]
    if unit is None and len(words) > 1 and words[-1] in _UNITS:
        unit = words.pop()
    if unit is None and len(words) > 2 and words[-1] == "2" and words[-2] == "mps":
        unit = "mps2"
        del words[-2:]
    return _meaning(tuple(words), unit)


def _meaning(words: tuple[str, ...], unit: str | None) -> ColumnName:
    if not words:
        return ColumnName(Meaning.OTHER, (), unit)
    if len(words) == 1:
        return ColumnName(_lone(words[0], unit), (), unit)
    axis = next((word for word in (words[-1], words[0]) if word in (*_AXES, *_X, *_Y)), None)
    if axis is not None:
        at = len(words) - 1 if words[-1] == axis else 0
        context = (*words[:at], *words[at + 1 :])
        if axis in _AXES and not _ROTATIONS.isdisjoint(context):
            return ColumnName(Meaning(f"q{axis}"), context, unit)
        if _OTHERS.isdisjoint(context) and (meaning := _lone(axis, unit)) in (Meaning.X, Meaning.Y):
            return ColumnName(meaning, context, unit)
    if _OTHERS.isdisjoint(words) and not _HEADINGS.isdisjoint(words) and _is_angle(unit):
        return ColumnName(Meaning.YAW, tuple(w for w in words if w not in _HEADINGS), unit)
    # The z of `angular.z` is no height, and the S of `b_w_RS_S_x` no distance.
    letters = (words[0], "z") if _OTHERS.isdisjoint(words) else (words[0],)
    telling = [word for word in words if len(word) > 1 or word in letters]
    meanings = [_MEANING_OF[word] for word in telling if word in _MEANING_OF]
    return ColumnName(meanings[0] if meanings else Meaning.OTHER, words, unit)


def _lone(word: str, unit: str | None) -> Meaning:
    if word in ("qx", "qy", "qz", "qw"):
        return Meaning(word)
    is_length = unit is None or unit in _METRES or unit in _OTHER_LENGTHS
    if word in _X | _Y and is_length:
        return Meaning.X if word in _X else Meaning.Y
    if word in _HEADINGS | _LONE_HEADINGS and _is_angle(unit):
        return Meaning.YAW
    return _MEANING_OF.get(word, Meaning.OTHER)


def _is_angle(unit: str | None) -> bool:
    return unit is None or unit in _RADIANS or unit in _DEGREES or unit == "compass"


def is_metres(unit: str | None) -> bool:
    """Return whether a unit is m, or none is named."""
    return unit is None or unit in _METRES


def is_radians(unit: str | None) -> bool:
    """Return whether a unit is rad."""
    return unit in _RADIANS


def is_degrees(unit: str | None) -> bool:
    """Return whether a unit is degrees."""
    return unit in _DEGREES
