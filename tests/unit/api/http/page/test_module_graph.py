"""What the first use needs, in the order in which a browser would run it."""

from collections.abc import Mapping

import pytest

from api.http.page.module_graph import Modules
from api.http.page.module_text import PageError


def modules(texts: Mapping[str, str]) -> Modules:
    named = {f"js/{name}.js": text for name, text in texts.items()}
    return Modules.reached_from("js/main.js", named.get)


def needs(*names: str) -> str:
    return "".join(f'import "/web/js/{name}.js";\n' for name in names)


def later(*names: str) -> str:
    return "".join(f'const load_{name} = () => import("/web/js/{name}.js");\n' for name in names)


def paths(*names: str) -> list[str]:
    return [f"js/{name}.js" for name in names]


def test_what_a_module_imports_runs_before_it_and_once() -> None:
    found = modules(
        {"main": needs("b", "a"), "b": needs("a", "c"), "a": "", "c": needs("a"), "unused": "?"}
    )

    assert [module.path for module in found.first] == paths("a", "c", "b", "main")
    assert found.later == {}


def test_what_is_imported_on_demand_comes_later_without_what_is_there() -> None:
    found = modules(
        {"main": needs("a") + later("task"), "a": "", "task": needs("a", "form"), "form": ""}
    )

    assert [module.path for module in found.first] == paths("a", "main")
    (portion,) = found.later.values()
    assert [module.path for module in portion] == paths("form", "task")


def test_what_two_entries_need_is_apart_so_that_they_get_the_same_module() -> None:
    found = modules(
        {
            "main": later("task", "drawer"),
            "task": needs("slider") + later("preview"),
            "drawer": needs("slider"),
            "slider": "",
            "preview": needs("slider"),
        }
    )

    by_users = {users: [each.path for each in held] for users, held in found.later.items()}
    assert by_users == {
        tuple(paths("drawer", "preview", "task")): paths("slider"),
        tuple(paths("drawer")): paths("drawer"),
        tuple(paths("preview")): paths("preview"),
        tuple(paths("task")): paths("task"),
    }


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        ({"main": needs("a")}, "web/js/main.js: there is no web/js/a.js"),
        ({"main": later("a")}, "web/js/main.js: there is no web/js/a.js"),
        (
            {"main": 'import { b } from "/web/js/a.js";\n', "a": "export const a = 1;\n"},
            "web/js/main.js: web/js/a.js does not export b",
        ),
        (
            {"main": needs("a"), "a": needs("b"), "b": needs("a")},
            "web/js/a.js: it imports itself, through js/b.js",
        ),
        (
            {"main": needs("a") + later("a"), "a": ""},
            "web/js/main.js: web/js/a.js is there from the start: import it so",
        ),
    ],
)
def test_what_cannot_be_loaded_is_an_error(texts: Mapping[str, str], message: str) -> None:
    with pytest.raises(PageError) as raised:
        modules(texts)

    assert str(raised.value) == message
