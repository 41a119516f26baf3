from pathlib import Path

import pytest
from coverage import Coverage, CoverageData

from tests.support.module_coverage import Reach, own_contexts, reach_of

SOURCE = """\
def sign(number):
    if number < 0:
        return -1
    return 1
"""
OWN = "tests/unit/domain/test_signs.py::test_a_negative_number|run"
OTHER = "tests/unit/domain/test_elsewhere.py::test_a_positive_number|run"


@pytest.fixture
def module(tmp_path: Path) -> Path:
    found = tmp_path / "domain" / "signs.py"
    found.parent.mkdir()
    found.write_text(SOURCE, encoding="utf-8")
    return found


@pytest.fixture
def measured(tmp_path: Path, module: Path) -> Coverage:
    """Return a run in which each of two test files went one of the two ways."""
    name = str(module)
    data = CoverageData(str(tmp_path / "measured"))
    data.set_context("")
    data.add_arcs({name: [(-1, 1), (1, -1)]})
    data.set_context(OWN)
    data.add_arcs({name: [(-1, 2), (2, 3), (3, -1)]})
    data.set_context(OTHER)
    data.add_arcs({name: [(-1, 2), (2, 4), (4, -1)]})
    data.write()
    found = Coverage(data_file=str(tmp_path / "measured"), branch=True, config_file=False)
    found.load()
    return found


def test_all_tests_together_reach_what_any_of_them_does(measured: Coverage, module: Path) -> None:
    assert reach_of(module, measured) == Reach(total=6, reached=6)


def test_what_only_the_tests_of_others_reach_does_not_count(
    measured: Coverage, module: Path, tmp_path: Path
) -> None:
    own = reach_of(module, measured, own_contexts(module, tmp_path))

    assert own == Reach(total=6, reached=4, missing="2, 4")
    assert round(own.percent, 1) == 66.7


def test_a_module_of_which_nothing_runs_is_reached() -> None:
    assert Reach(total=0, reached=0).percent == 100.0
