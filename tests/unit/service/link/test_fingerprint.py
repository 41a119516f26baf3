"""Two computers of a robot see by a fingerprint whether they have the same model."""

from dataclasses import dataclass, replace

import pytest

from domain.parts.mode_settings import ModeSettings
from domain.parts.system_model import EVERY_MODE, SmhModel
from domain.state_and_mode import ModeName
from domain.timebase import seconds
from service.files.model_file import read_model
from service.link.fingerprint import fingerprint_of, model_fingerprint
from tests.support.guarded_model_text import guarded_model_text
from tests.support.models import BASE, actuation_model

GUARDED = guarded_model_text(4)


def test_the_same_model_has_the_same_fingerprint_from_whatever_text() -> None:
    commented = f"# of today\n{GUARDED}\n"

    assert model_fingerprint(read_model(commented).model) == model_fingerprint(
        read_model(GUARDED).model
    )


def test_it_is_32_hexadecimal_digits() -> None:
    assert len(bytes.fromhex(model_fingerprint(actuation_model()))) == 16


def test_another_parameter_of_a_mode_is_another_model() -> None:
    model = actuation_model()
    base = model.nodes[BASE]
    modes = {**base.modes, ModeName("FAST"): {"max_speed": 9.9}}
    other = SmhModel({**model.nodes, BASE: replace(base, modes=modes)}, model.systems)

    assert model_fingerprint(other) != model_fingerprint(model)


def test_modes_in_another_order_are_another_model() -> None:
    model = actuation_model()
    base = model.nodes[BASE]
    turned = replace(base, modes=dict(reversed(list(base.modes.items()))))
    other = SmhModel({**model.nodes, BASE: turned}, model.systems)

    assert model_fingerprint(other) != model_fingerprint(model)


def test_a_setting_of_a_mode_is_part_of_the_model() -> None:
    model = actuation_model()
    settings = {BASE: {EVERY_MODE: ModeSettings(grace=seconds(2))}}

    assert model_fingerprint(SmhModel(model.nodes, model.systems, settings)) != model_fingerprint(
        model
    )


def test_a_setting_that_the_next_release_adds_changes_nothing_where_it_is_not_used() -> None:
    def of_this_release() -> object:
        @dataclass(frozen=True)
        class Settings:
            limit: int = 1

        return Settings(2)

    def of_the_next_release(further: str = "") -> object:
        @dataclass(frozen=True)
        class Settings:
            limit: int = 1
            further: str = ""

        return Settings(2, further)

    assert fingerprint_of(of_this_release()) == fingerprint_of(of_the_next_release())
    assert fingerprint_of(of_this_release()) != fingerprint_of(of_the_next_release("used"))


def test_what_has_no_fingerprint_is_no_model() -> None:
    with pytest.raises(TypeError):
        fingerprint_of(object())
