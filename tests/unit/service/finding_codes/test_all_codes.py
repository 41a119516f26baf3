import re
from collections import Counter

from service.finding_codes.all_codes import FINDING_CODES, OF_MODELS
from service.finding_codes.file_codes import ALL_FILES, ROBOT_FILES, WAYPOINT_FILES
from tests.support.shared import PROJECT

_SOURCES = ("service/files", "domain/conditions", "domain/parts/lint")
_MODULES = (
    "domain/health/monitor_graph.py",
    "domain/parts/errors_check.py",
    "domain/parts/invariant_circles.py",
    "domain/parts/reactions_check.py",
    "domain/parts/settings_check.py",
    "domain/parts/system_model.py",
)
_CODE = re.compile(r'"(ALIAS|CYCLE|HEADER|[A-Z]+(?:_[A-Z]+)+)"')
_NO_FINDINGS = frozenset(
    {
        # Codes of whole problems, which hold findings.
        "INVALID_ROBOT_FILE",
        "INVALID_WAYPOINTS",
        "UNREADABLE_FILE",
        # What conditions compare with, codes of blockers, and an error of parts.
        "INVARIANT_BROKEN",
        "NO_TASK",
        "PAUSED_TASK",
        "RUNNING_TASK",
        "UNKNOWN_VALUE",
    }
)
_FROM_NAMES = frozenset({"UNKNOWN_ERROR"})
"""Codes that the check of conditions puts together."""


def test_each_code_that_exists_is_explained_and_no_other() -> None:
    paths = [path for folder in _SOURCES for path in (PROJECT / folder).glob("*.py")]
    paths += [PROJECT / module for module in _MODULES]
    used = {code for path in paths for code in _CODE.findall(path.read_text(encoding="utf-8"))}

    assert (used - _NO_FINDINGS) | _FROM_NAMES == set(FINDING_CODES)


def test_each_code_is_explained_once() -> None:
    codes = Counter(own.code for own in (*OF_MODELS, *ROBOT_FILES, *WAYPOINT_FILES, *ALL_FILES))

    assert [code for code, number in codes.items() if number > 1] == []


def test_each_explanation_is_a_sentence_that_says_what_to_do() -> None:
    for own in FINDING_CODES.values():
        assert own.meaning.endswith("."), own.code
        assert "\n" not in own.meaning + own.mend, own.code
        assert own.mend, own.code
