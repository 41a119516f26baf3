import pytest

from service.files.yaml_tree import MAX_DEPTH, Mapping, Scalar, Sequence, read_tree


def faults(text: str) -> list[tuple[str, int | None, int | None]]:
    return [(finding.code, finding.line, finding.column) for finding in read_tree(text).findings]


def test_every_key_and_value_knows_where_it_stands() -> None:
    tree = read_tree("# a comment\narm:\n  speed: 0.2\n  list: [1, 'two']\n")

    assert tree.is_complete
    assert tree.documents == [
        Mapping(
            2,
            1,
            [
                (
                    Scalar(2, 1, "arm"),
                    Mapping(
                        3,
                        3,
                        [
                            (Scalar(3, 3, "speed"), Scalar(3, 10, "0.2")),
                            (
                                Scalar(4, 3, "list"),
                                Sequence(4, 9, [Scalar(4, 10, "1"), Scalar(4, 13, "two", True)]),
                            ),
                        ],
                    ),
                )
            ],
        )
    ]


def test_anchors_are_accepted_where_nothing_refers_to_them() -> None:
    assert read_tree("a: &speed 0.1\n").documents == [
        Mapping(1, 1, [(Scalar(1, 1, "a"), Scalar(1, 4, "0.1"))])
    ]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        pytest.param("a: 1\nb: *a\n", ("ALIAS", 2, 4), id="an alias"),
        pytest.param("a: 1\n<<: {b: 1}\n", ("MERGE_KEY", 2, 1), id="a merge key"),
        pytest.param("a: 1\nb: 2\na: 3\n", ("DUPLICATE_KEY", 3, 1), id="a key twice"),
        pytest.param("? [a]\n: 1\n", ("INVALID_KEY", 1, 3), id="a list as key"),
        pytest.param("'': 1\n", ("INVALID_KEY", 1, 1), id="an empty key"),
        pytest.param("a: [1,\n", ("YAML_SYNTAX", 2, 1), id="a list that does not end"),
        pytest.param("a: 1\n b: 2\n", ("YAML_SYNTAX", 2, 3), id="a wrong indentation"),
        pytest.param("a: é\x00\n", ("YAML_SYNTAX", 1, 5), id="a null character"),
        pytest.param("a: 1\nb: \ud800\n", ("YAML_SYNTAX", 2, 4), id="half a character"),
    ],
)
def test_a_fault_is_told_with_its_place(text: str, fault: tuple[str, int, int]) -> None:
    assert faults(text) == [fault]


def test_what_was_complained_of_is_left_out_and_the_rest_is_read() -> None:
    tree = read_tree("a: *x\n<<: {c: 1}\nb: 2\nb: 3\n")

    assert tree.documents == [
        Mapping(1, 1, [(Scalar(1, 1, "a"), None), (Scalar(3, 1, "b"), Scalar(3, 4, "2"))])
    ]


def test_a_quoted_merge_key_is_a_key_like_any_other() -> None:
    assert faults("'<<': 1\n") == []


def test_after_a_fault_of_syntax_the_tree_is_not_complete() -> None:
    assert not read_tree("a: 1\n---\nb: [\n").is_complete


@pytest.mark.parametrize("opening", ["[", "{a: ", "- ", "? "])
def test_a_hundred_thousand_openings_are_a_finding_and_not_a_crash(opening: str) -> None:
    ours, parsers = MAX_DEPTH * len(opening) + 1, 1_001

    # Brackets are read ahead of their events: where the parser has a bound, that comes first.
    assert faults(opening * 100_000) in (
        [[("TOO_DEEP", 1, ours)], [("TOO_DEEP", 1, parsers)]]
        if opening == "["
        else [[("TOO_DEEP", 1, ours)]]
    )


def test_as_many_levels_as_are_allowed_are_read() -> None:
    assert read_tree("[" * MAX_DEPTH + "]" * MAX_DEPTH).is_complete


def test_a_text_of_too_many_values_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.files.yaml_tree.MAX_EVENTS", 12)

    assert faults("[1, 2, 3, 4]") == []
    assert faults("[1, 2, 3, 4, 5, 6, 7, 8]") == [("TOO_LARGE", 1, 24)]


def test_a_flood_of_tag_directives_is_refused_at_once() -> None:
    flood = "".join(f"%TAG !a{number}! x\n" for number in range(100_000))

    assert faults(f"{flood}---\na: 1\n") == [("TOO_LARGE", 1, 1)]


def test_a_tag_constructs_nothing() -> None:
    tree = read_tree("a: !!python/object/apply:os.system ['true']\n")

    assert tree.findings == []
    assert tree.documents == [
        Mapping(1, 1, [(Scalar(1, 1, "a"), Sequence(1, 4, [Scalar(1, 37, "true", True)]))])
    ]
