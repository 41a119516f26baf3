import pytest

from domain.errors import InvalidValueError, UnknownParameterError
from domain.parameters import ParameterValue
from domain.parts.system_model import NodeModel
from domain.simulation.node_parameters import declared_parameters, find_refusal, start_parameters
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName


def test_a_node_declares_what_any_of_its_modes_sets_and_the_first_mode_decides_the_type() -> None:
    node = NodeModel(
        PartName("arm"),
        {DEFAULT_MODE: {"torque": 0.1}, ModeName("STRONG"): {"torque": 1, "grip": True}},
    )

    assert declared_parameters(node) == {"torque": 0.1, "grip": True}


def test_a_node_without_modes_declares_nothing() -> None:
    assert declared_parameters(NodeModel(PartName("lamp"))) == {}


@pytest.mark.parametrize(
    ("declared", "start"),
    [(True, False), (7, 0), (0.5, 0.0), ("PID", "none"), ((1.0, 2.0), ())],
)
def test_a_parameter_starts_with_a_value_of_its_type_that_nobody_set(
    declared: ParameterValue, start: ParameterValue
) -> None:
    value = start_parameters({"it": declared})["it"]

    assert (type(value), value) == (type(start), start)


@pytest.mark.parametrize(
    ("declared", "value"),
    [
        (True, False),
        (7, -1),
        (0.5, float("inf")),
        ("PID", ""),
        ((1.0,), (2.0, 3.0)),
        ((1.0,), ()),
        ((), ("a",)),
    ],
)
def test_a_value_of_the_same_type_is_taken(declared: ParameterValue, value: ParameterValue) -> None:
    assert find_refusal({"it": declared}, {"it": value}) is None


@pytest.mark.parametrize(
    ("declared", "value", "message"),
    [
        (0.5, 1, "it is of type double, not integer"),
        (1, 1.0, "it is of type integer, not double"),
        (1, True, "it is of type integer, not bool"),
        (True, 1, "it is of type bool, not integer"),
        ("PID", ("PID",), "it is of type string, not string_array"),
        ((1.0,), 1.0, "it is of type double_array, not double"),
        ((1.0,), (1,), "it is of type double_array, not integer_array"),
        ((1,), (True,), "it is of type integer_array, not bool_array"),
        ((), 1, "it is of type array, not integer"),
    ],
)
def test_a_value_of_another_type_is_not_taken(
    declared: ParameterValue, value: ParameterValue, message: str
) -> None:
    refusal = find_refusal({"it": declared}, {"it": value})

    assert isinstance(refusal, InvalidValueError)
    assert (refusal.message, refusal.pointer) == (message, "it")


def test_a_parameter_that_was_not_declared_is_not_taken() -> None:
    refusal = find_refusal({"torque": 0.1}, {"torque": 0.2, "wheels": 3})

    assert isinstance(refusal, UnknownParameterError)
    assert (refusal.name, refusal.hint) == ("wheels", "known: torque")
