"""numpy is loaded by its first use, which only a new interpreter shows."""

import subprocess
import sys
import threading

import numpy
import pytest

from domain.arrays import is_numpy_loaded, load_numpy, np

THREADS = """
import sys, threading
from domain.arrays import np

begin, roots = threading.Barrier(8), []

def use():
    begin.wait()
    roots.append(float(np.sqrt(4.0)))

threads = [threading.Thread(target=use) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(roots == [2.0] * 8)
"""


def printed_by(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()


def is_loaded_after(*lines: str) -> bool:
    ending = "print('numpy' in sys.modules, is_numpy_loaded())"
    code = "\n".join(("import sys", "from domain.arrays import *", *lines, ending))
    printed = printed_by(code)
    assert printed in ("True True", "False False")
    return printed == "True True"


def test_nothing_is_loaded_before_it_is_used() -> None:
    assert not is_loaded_after()


@pytest.mark.parametrize("use", ["load_numpy()", "np.ndarray"])
def test_what_is_used_is_loaded(use: str) -> None:
    assert is_loaded_after(use)


@pytest.mark.parametrize(
    "annotation", ["Floats | None", "tuple[Integers, ...]", "dict[str, Floats]"]
)
def test_annotations_load_nothing(annotation: str) -> None:
    get = "from typing import get_type_hints"
    assert not is_loaded_after(f"def f(value: {annotation}): ...", get, "get_type_hints(f)")


def test_whoever_looks_at_the_module_does_not_load_it() -> None:
    assert not is_loaded_after("import inspect", "repr(np)", "inspect.unwrap(np)")
    assert not hasattr(np, "__path__")


def test_threads_may_be_the_first_at_the_same_time() -> None:
    assert printed_by(THREADS) == "True"


def test_names_are_those_of_numpy() -> None:
    assert np.hypot is numpy.hypot
    assert np.random.PCG64 is numpy.random.PCG64
    with pytest.raises(AttributeError, match="no_such_function"):
        np.no_such_function  # type: ignore[attr-defined]  # noqa: B018


def test_a_name_is_looked_up_once() -> None:
    # Used by nothing else here.
    vars(np).pop("nextafter", None)

    assert np.nextafter is numpy.nextafter
    assert vars(np)["nextafter"] is numpy.nextafter


def test_loading_it_again_changes_nothing() -> None:
    load_numpy()
    before = dict(vars(np))
    threads = [threading.Thread(target=load_numpy) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert vars(np) == before
    assert is_numpy_loaded()
