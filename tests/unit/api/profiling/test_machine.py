import os

import pytest

from api.profiling.machine import load_facts, machine_facts


def test_a_figure_depends_on_processor_kernel_and_python() -> None:
    facts = machine_facts()

    assert list(facts) == ["CPU", "cores", "system", "Python"]
    assert all(facts.values())


def test_the_load_and_the_priority_over_it_are_named() -> None:
    facts = load_facts()

    assert float(facts["average before"]) >= 0
    assert facts["scheduling"].startswith("normal, nice ")


def test_a_real_time_priority_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getscheduler", lambda _: os.SCHED_RR)
    monkeypatch.setattr(os, "sched_getparam", lambda _: os.sched_param(10))

    assert load_facts()["scheduling"] == "SCHED_RR, priority 10"
