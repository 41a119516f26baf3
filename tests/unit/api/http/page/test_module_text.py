"""Modules taken apart, and the forms that nobody may use without noticing."""

import pytest

from api.http.page.module_text import Import, Module, PageError, squeeze

TEXT = """\
/** A list. */

import { el, setText as set } from "/web/js/base/dom.js";
import * as words from "/web/js/base/words.js";
import {
  one,
  two,
} from "/web/js/base/numbers.js";
import "/web/js/base/pills.js";

/** How many.
 *
 * import nothing from "here";
 */
export const MOST = 3; // more would not fit

export async function load() {
  // Later.
  const { Sheet } = await import("/web/js/task/sheet.js");
  return `${MOST ? `of ${MOST}` : " "}`;
}

export class List {
  #items = /[/*]/;
}
"""


def test_a_module_is_what_it_imports_what_it_exports_and_a_body() -> None:
    module = Module.read("js/parts/list.js", TEXT)

    assert module.imports == (
        Import("js/base/dom.js", (("el", "el"), ("setText", "set")), None),
        Import("js/base/words.js", (), "words"),
        Import("js/base/numbers.js", (("one", "one"), ("two", "two")), None),
        Import("js/base/pills.js", (), None),
    )
    assert module.exports == ("MOST", "load", "List")
    assert module.later == ("js/task/sheet.js",)
    assert module.body == (
        "const MOST = 3; // more would not fit\n"
        "async function load() {\n"
        'const { Sheet } = await import("/web/js/task/sheet.js");\n'
        'return `${MOST ? `of ${MOST}` : " "}`;\n'
        "}\n"
        "class List {\n"
        "#items = /[/*]/;\n"
        "}\n"
    )


def test_an_import_on_demand_can_lead_elsewhere() -> None:
    module = Module.read("js/a.js", TEXT)

    assert "await load_of(js/task/sheet.js);" in module.body_with(lambda path: f"load_of({path})")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("export default class {}", "only plain imports and exports"),
        ("export { a };", "only plain imports and exports"),
        ('export * from "/web/js/b.js";', "only plain imports and exports"),
        ("export let changing = 1;", "only plain imports and exports"),
        ("export const { a, b } = c;", "only plain imports and exports"),
        ('import a from "/web/js/b.js";', "only plain imports and exports"),
        ('import { a } from "./b.js";', "only plain imports and exports"),
        ('import { a } from "https://elsewhere/b.js";', "only plain imports and exports"),
        ('import { a b } from "/web/js/b.js";', "an import that cannot be bundled"),
        ("const here = import.meta.url;", "only plain imports and exports"),
        ("function f(path) { return import(path); }", "import() needs a path in quotes"),
        ('function f() { return import("./b.js"); }', "import() needs a path in quotes"),
        ("const a = await fetch(path);", "must not wait while it is loaded"),
        ("await fetch(path);", "must not wait while it is loaded"),
        ("const text = `over\nlines`;", "a literal over lines"),
        ('const text = "a \\\nb";', "a literal over lines"),
        ("/* why */ const a = 1;", "code behind a comment"),
        ("/*\n * why\n */ const a = 1;", "code behind a comment"),
    ],
)
def test_a_form_that_is_not_known_is_an_error_that_names_the_file(text: str, why: str) -> None:
    with pytest.raises(PageError, match=r"^web/js/a\.js: ") as raised:
        Module.read("js/a.js", f"{text}\n")

    assert why in str(raised.value)


def test_a_style_sheet_loses_its_comments_and_indentation() -> None:
    sheet = "/* Normal is grey.\n   Really. */\nbody {\n  color: grey; /* why */\n}\n"

    assert squeeze("style/a.css", sheet) == "body {\ncolor: grey; /* why */\n}\n"
