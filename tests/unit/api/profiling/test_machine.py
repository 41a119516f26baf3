from api.profiling.machine import machine_facts


def test_a_figure_depends_on_processor_kernel_and_python() -> None:
    facts = machine_facts()

    assert list(facts) == ["CPU", "cores", "system", "Python"]
    assert all(facts.values())
