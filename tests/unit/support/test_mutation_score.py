from tests.support.mutation_score import scores

RESULTS = """\
    domain.lifecycle.x_arrival__mutmut_1: killed
    domain.lifecycle.x_arrival__mutmut_2: survived
    domain.tasks.holds.xǁHoldsǁset__mutmut_1: killed
    domain.tasks.holds.xǁHoldsǁset__mutmut_2: timeout
    domain.tasks.holds.xǁHoldsǁset__mutmut_3: no tests
"""


def test_mutants_are_counted_by_module_and_by_how_they_ended() -> None:
    found = scores(RESULTS.splitlines())

    assert found.keys() == {"domain.lifecycle", "domain.tasks.holds"}
    assert found["domain.lifecycle"].ends == {"killed": 1, "survived": 1}
    assert found["domain.tasks.holds"].ends == {"killed": 1, "timeout": 1, "no tests": 1}


def test_one_that_never_ends_was_noticed_and_one_without_tests_was_not() -> None:
    found = scores(RESULTS.splitlines())

    assert found["domain.lifecycle"].percent == 50.0
    assert round(found["domain.tasks.holds"].percent, 1) == 66.7


def test_what_is_no_result_is_passed_over() -> None:
    assert scores(["", "Warning: something else", "Total: 3"]) == {}
