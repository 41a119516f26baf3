"""Models that tests talk about; the robot of D4.8, Annex 4, and a nested one."""

from domain.lifecycle import LifecycleState
from domain.parts.system_model import NodeModel, SmhModel, SystemModel
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName, StateAndMode

ACTUATION, BASE, ARM = PartName("actuation"), PartName("drive_base"), PartName("manipulator")
SLOW, FAST = ModeName("SLOW"), ModeName("FAST")
WEAK, STRONG = ModeName("WEAK"), ModeName("STRONG")
MODERATE, PERFORMANCE = ModeName("MODERATE"), ModeName("PERFORMANCE")


def active(mode: str = DEFAULT_MODE) -> StateAndMode:
    """Return active in a mode."""
    return StateAndMode(LifecycleState.ACTIVE, ModeName(mode))


def inactive() -> StateAndMode:
    """Return inactive."""
    return StateAndMode(LifecycleState.INACTIVE)


def actuation_model() -> SmhModel:
    """Return the example of D4.8, Annex 4, with a torque of its own for WEAK."""
    base = NodeModel(
        BASE,
        {
            DEFAULT_MODE: {"max_speed": 0.1, "controller": "PID"},
            SLOW: {"max_speed": 0.2, "controller": "PID"},
            FAST: {"max_speed": 0.9, "controller": "MPC"},
        },
    )
    arm = NodeModel(
        ARM,
        {
            DEFAULT_MODE: {"max_torque": 0.1},
            WEAK: {"max_torque": 0.15},
            STRONG: {"max_torque": 0.2},
        },
    )
    actuation = SystemModel(
        ACTUATION,
        {
            DEFAULT_MODE: {ARM: inactive(), BASE: active()},
            MODERATE: {ARM: active(WEAK), BASE: active(SLOW)},
            PERFORMANCE: {ARM: active(STRONG), BASE: active(FAST)},
        },
    )
    return SmhModel({BASE: base, ARM: arm}, {ACTUATION: actuation})


def nested_model() -> SmhModel:
    """Return a robot whose system consists of the actuation system and a sensor."""
    inner = actuation_model()
    robot, lidar = PartName("robot"), PartName("lidar")
    wide = ModeName("WIDE")
    sensor = NodeModel(lidar, {DEFAULT_MODE: {"rate": 5}, wide: {"rate": 20}})
    system = SystemModel(
        robot,
        {
            DEFAULT_MODE: {ACTUATION: active(), lidar: active()},
            ModeName("RACE"): {ACTUATION: active(PERFORMANCE), lidar: active(wide)},
            ModeName("PARKED"): {ACTUATION: inactive(), lidar: active()},
        },
    )
    return SmhModel({**inner.nodes, lidar: sensor}, {**inner.systems, robot: system})
