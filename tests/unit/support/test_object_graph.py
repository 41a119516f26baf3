from functools import partial
from types import MethodType, SimpleNamespace

import numpy as np

from tests.support.object_graph import growth, sizes_of


def test_what_is_in_a_structure_counts_at_any_depth() -> None:
    inner = SimpleNamespace(name="a", more=[1, 2, 3])
    root = SimpleNamespace(items={"a": inner}, count=1)

    sizes = sizes_of(root)

    # The key and the value; and of the value its two attributes, and three numbers in the list.
    assert sizes[".items{}"] == 1
    assert sizes[".items[]"] == 6
    assert sizes[".count"] == 1


def test_an_object_counts_where_it_is_found_first() -> None:
    shared = [1, 2, 3]

    sizes = sizes_of(SimpleNamespace(first=[shared], second=[shared]))

    assert (sizes[".first[]"], sizes[".second[]"]) == (4, 1)


def test_an_array_counts_its_elements() -> None:
    assert sizes_of(SimpleNamespace(path=np.zeros((5, 3))))[".path"] == 15


def test_what_functions_hold_is_found() -> None:
    held = [1, 2, 3]
    owner = SimpleNamespace(held=held)

    assert sizes_of(SimpleNamespace(call=partial(print, held)))[".call()"] >= 5
    assert sizes_of(SimpleNamespace(call=lambda: held))[".call()"] >= 4
    assert sizes_of(SimpleNamespace(call=MethodType(print, owner)))[".call.self.held[]"] == 3


def test_growth_is_told_by_share_the_worst_first() -> None:
    before = {".a[]": 100, ".b[]": 100, ".few": 1}
    after = {".a[]": 150, ".b[]": 300, ".few": 10, ".new": 50}

    assert list(growth(before, after).items()) == [(".new", 50.0), (".b[]", 2.0), (".a[]", 0.5)]
