"""The five signals of a robot without sensors: each value is a parameter of the node `signals`.

Publishes them 20 times a second in the types of `pilothouse_msgs`, and a value that was set at
once. Run it: `python3 signals.py`, and change a value:

    ros2 param set /signals battery_level 0.1
    ros2 param set /signals estop true

or move the sliders of rqt_reconfigure. A signal falls silent, as with a sensor that died, by

    ros2 param set /signals publish.temperature false
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import rclpy
from pilothouse_msgs.msg import (
    BatteryLevel,
    EmergencyStop,
    GpsAccuracy,
    SignalStrength,
    Temperature,
)
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
)
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter

RATE_HZ = 20.0


@dataclass(frozen=True)
class Signal:
    """One signal: its topic and its parameter have the same name."""

    name: str
    message: Callable[..., Any]
    field: str
    value: bool | int | float
    about: str
    least: float = 0.0
    most: float = 0.0


SIGNALS = (
    Signal("battery_level", BatteryLevel, "battery_level", 0.8, "remaining charge", 0.0, 1.0),
    Signal("estop", EmergencyStop, "enabled", False, "whether the stop is pressed"),
    Signal("gps_accuracy", GpsAccuracy, "accuracy", 100.0, "in mm", 0.0, 300.0),
    Signal("signal_strength", SignalStrength, "strength", 1, "0 none, 1 good, 2 low", 0, 2),
    Signal("temperature", Temperature, "temperature", 30.0, "in degrees Celsius", 0.0, 100.0),
)


class Signals(Node):
    """Publishes the values of its parameters."""

    def __init__(self) -> None:
        super().__init__("signals")
        self._topics = {
            signal.name: self.create_publisher(signal.message, f"/{signal.name}", 10)
            for signal in SIGNALS
        }
        for signal in SIGNALS:
            self.declare_parameter(signal.name, signal.value, _described(signal))
            self.declare_parameter(f"publish.{signal.name}", True)
        self.add_post_set_parameters_callback(self._tell_set)
        self.create_timer(1 / RATE_HZ, self._tell_all)

    def _tell_all(self) -> None:
        for signal in SIGNALS:
            self._tell(signal)

    def _tell_set(self, parameters: list[Parameter]) -> None:
        """Publish a value at once that was set: an emergency stop must not wait."""
        changed = {parameter.name for parameter in parameters}
        for signal in SIGNALS:
            if signal.name in changed:
                self._tell(signal)

    def _tell(self, signal: Signal) -> None:
        if not self.get_parameter(f"publish.{signal.name}").value:
            return
        message = signal.message(**{signal.field: self.get_parameter(signal.name).value})
        message.header.stamp = self.get_clock().now().to_msg()
        self._topics[signal.name].publish(message)


def _described(signal: Signal) -> ParameterDescriptor:
    """Return what rqt shows of a parameter; values beyond its range are refused."""
    described = ParameterDescriptor(description=signal.about)
    if isinstance(signal.value, float):
        span = FloatingPointRange(from_value=signal.least, to_value=signal.most)
        described.floating_point_range = [span]
    elif not isinstance(signal.value, bool):
        steps = IntegerRange(from_value=int(signal.least), to_value=int(signal.most), step=1)
        described.integer_range = [steps]
    return described


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    node = Signals()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
