import pytest

from service.files.parameter_file import read_parameter_file
from service.files.smh_block import SmhBlock
from service.files.yaml_tree import read_tree


def block_of(text: str) -> SmhBlock:
    (source,) = read_parameter_file(read_tree(text).documents).nodes.values()
    return SmhBlock(source)


def test_what_is_written_is_sorted_by_what_it_is_about() -> None:
    block = block_of(
        """
s:
  ros__parameters:
    type: system
    parts: [arm]
    description: keys that mean nothing here are left alone
    mode_settings: {FAST: {grace: 1}}
    modes: {__DEFAULT__: {arm: active}, FAST: {arm: active.FAST}}
    rules: {slow_down: {if_target: active.FAST}}
"""
    )

    assert block.findings == []
    assert not block.is_node
    assert [parameter.value for parameter in block.parts] == [("arm",)]
    assert {mode: [name for name, _ in lines] for mode, lines in block.modes.items()} == {
        "__DEFAULT__": ["arm"],
        "FAST": ["arm"],
    }
    assert {name: list(lines) for name, lines in block.rules.items()} == {
        "slow_down": ["if_target"]
    }


@pytest.mark.parametrize(
    ("body", "is_node"),
    [
        ("type: node", True),
        ("type: 'node'", True),
        ("type: system", False),
        ("modes: {__DEFAULT__: {ros__parameters: {a: 1}}, FAST: {ros__parameters: {a: 2}}}", True),
        ("modes: {__DEFAULT__: {n: active}}", False),
    ],
)
def test_a_part_is_a_node_if_it_says_so_or_looks_like_one(body: str, is_node: bool) -> None:
    assert block_of(f"n: {{ros__parameters: {{{body}}}}}").is_node is is_node


@pytest.mark.parametrize(
    ("text", "finding"),
    [
        pytest.param(
            "n: {ros__parameters: {x: 1}}", ("error", "MISSING_TYPE", 1), id="C++ drops the part"
        ),
        pytest.param(
            "n: {ros__parameters: {type: gadget}}",
            ("warning", "UNKNOWN_TYPE", 29),
            id="C++ takes everything but node as a system",
        ),
        pytest.param(
            "n: {ros__parameters: {type: node, modes: FAST}}",
            ("error", "NOT_A_BLOCK", 35),
            id="modes without keys",
        ),
        pytest.param(
            "n: {ros__parameters: {type: node, modes: {FAST: 1}}}",
            ("error", "NOT_A_BLOCK", 43),
            id="a mode without keys",
        ),
        pytest.param(
            "s: {ros__parameters: {type: system, rules: {r: 1}}}",
            ("error", "NOT_A_BLOCK", 45),
            id="a rule without keys",
        ),
        pytest.param(
            "left/modes: {ros__parameters: {type: node}}",
            ("error", "RESERVED_NAME", 1),
            id="a name that an address would take for something else",
        ),
    ],
)
def test_what_is_wrong_with_a_part_is_told(text: str, finding: tuple[str, str, int]) -> None:
    block = block_of(text)

    assert [(f.severity, f.code, f.column) for f in block.findings] == [finding]
    assert block.findings[0].part == block.name
