from domain.parts.mode_settings import ModeSettings, OnFailure


def test_a_mode_without_settings_is_entered_at_once_and_goes_on_after_a_failure() -> None:
    settings = ModeSettings()

    assert settings.transition.after == {}
    assert settings.transition.on_failure is OnFailure.CONTINUE
    assert settings.requires == settings.invariants == ()
