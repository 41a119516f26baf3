import pytest

from domain.parts.mode_settings import ModeSettings, TransitionSettings
from domain.parts.settings_check import check_settings
from domain.state_and_mode import DEFAULT_MODE, ModeName, PartName

S, A, B = PartName("s"), PartName("a"), PartName("b")
FAST, SLOW = ModeName("FAST"), ModeName("SLOW")


def told(settings: dict[ModeName, ModeSettings]) -> list[tuple[str, tuple[str, ...]]]:
    findings = check_settings(S, settings, (DEFAULT_MODE, FAST, SLOW), (A, B))
    return [(finding.code, finding.path) for finding in findings]


def after(order: dict[PartName, tuple[PartName, ...]]) -> ModeSettings:
    return ModeSettings(transition=TransitionSettings(after=order))


def test_settings_that_name_what_exists_are_fine() -> None:
    assert told({FAST: after({B: (A,)}), SLOW: ModeSettings(fallback=FAST)}) == []


@pytest.mark.parametrize(
    ("settings", "code", "path"),
    [
        pytest.param(
            {FAST: ModeSettings(fallback=ModeName("FASTER"))},
            "UNKNOWN_MODE",
            ("FAST", "fallback"),
            id="a fallback that is no mode",
        ),
        pytest.param(
            {FAST: after({B: (PartName("c"),)})},
            "UNKNOWN_PART",
            ("FAST", "transition", "after", "c"),
            id="an order of a part that is none",
        ),
        pytest.param(
            {FAST: after({A: (B,), B: (A,)})},
            "DAG_CYCLE",
            ("FAST", "transition", "after", "b"),
            id="parts that wait for each other",
        ),
        pytest.param(
            {FAST: ModeSettings(fallback=SLOW), SLOW: ModeSettings(fallback=FAST)},
            "FALLBACK_CIRCLE",
            ("SLOW", "fallback"),
            id="modes that fall back to each other",
        ),
    ],
)
def test_what_names_nothing_or_leads_back_is_an_error(
    settings: dict[ModeName, ModeSettings], code: str, path: tuple[str, ...]
) -> None:
    assert told(settings) == [(code, ("s", "mode_settings", *path))]
