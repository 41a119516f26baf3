"""Conditions with their places in a model file."""

from service.files.parameter_file import read_parameter_file
from service.files.smh_block import SmhBlock
from service.files.smh_condition import read_condition
from service.files.source_text import SourceText
from service.files.yaml_tree import Scalar, read_tree
from tests.support.http_robot import ACTUATION

PLACE = Scalar(3, 7, "estop")


def a_block() -> SmhBlock:
    sources = read_parameter_file(read_tree(ACTUATION).documents).nodes
    return SmhBlock(sources["actuation"])


def test_a_condition_is_noted_with_its_place_and_what_stands_before_it() -> None:
    block = a_block()

    condition = read_condition(block, SourceText(ACTUATION), "the guard", "  estop ", PLACE)

    assert condition is not None
    assert condition.text == "estop"
    (written,) = block.conditions
    assert (written.part, written.where) == ("actuation", "the guard")
    assert (written.condition, written.place, written.shift) == (condition, PLACE, 2)
    assert block.findings == []


def test_what_is_no_condition_is_a_finding_and_is_not_noted() -> None:
    block = a_block()

    assert read_condition(block, SourceText(ACTUATION), "the guard", "estop and", PLACE) is None

    assert block.conditions == []
    (finding,) = block.findings
    assert finding.severity == "error"
    assert finding.message.startswith("the guard: ")
