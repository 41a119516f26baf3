from domain.actor import Actor
from domain.inputs import Input, Reading, Readings
from domain.outbox import Outputs
from service.readings import DirectReadings


def test_readings_of_a_sender_without_a_name_are_of_the_api() -> None:
    submitted: list[Input] = []

    def submit(given: Input) -> Outputs:
        submitted.append(given)
        return Outputs()

    readings = DirectReadings(submit)
    battery = Reading("battery_level", 0.5)
    readings.submit([battery], actor=Actor("http:127.0.0.1"))
    readings.submit([battery], "gauge", Actor("http:127.0.0.1"))

    assert submitted == [
        Readings((battery,), "api", Actor("http:127.0.0.1")),
        Readings((battery,), "gauge", Actor("http:127.0.0.1")),
    ]
