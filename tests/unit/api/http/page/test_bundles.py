"""Many modules in few files; `tests/browser/test_page_files.py` lets a browser run them."""

import random
import zlib

from api.http.page.bundles import MOST_BYTES, make_bundles, pack
from api.http.page.module_graph import Modules

TEXTS = {
    "js/main.js": (
        'import { el as make, ONE } from "/web/js/base/dom.js";\n'
        'import * as words from "/web/js/base/words.js";\n'
        'import "/web/js/parts/list.js";\n'
        'make(ONE, words.label, () => import("/web/js/task/sheet.js"));\n'
    ),
    "js/base/dom.js": "export const ONE = 1;\nexport function el() {}\n",
    "js/base/words.js": "export function label() {}\n",
    "js/parts/list.js": "customElements.define();\n",
    "js/task/sheet.js": 'import { el } from "/web/js/base/dom.js";\nel();\n',
}


def test_a_module_keeps_a_scope_of_its_own() -> None:
    first, texts = make_bundles(Modules.reached_from("js/main.js", TEXTS.get))

    assert first == ["core-1.js"]
    assert texts["core-1.js"] == (
        "export const $base$dom=(()=>{\n"
        "const ONE = 1;\nfunction el() {}\n"
        "return{ONE,el};\n})();\n"
        "export const $base$words=(()=>{\n"
        "function label() {}\n"
        "return{label};\n})();\n"
        "export const $parts$list=(()=>{\n"
        "customElements.define();\n"
        "return{};\n})();\n"
        "export const $main=(()=>{\n"
        "const {el:make,ONE}=$base$dom;\n"
        "const words=$base$words;\n"
        "make(ONE, words.label, "
        '() => import("./task-sheet.js").then((made)=>made.$task$sheet));\n'
        "return{};\n})();\n"
    )


def test_what_comes_later_uses_what_is_there() -> None:
    _, texts = make_bundles(Modules.reached_from("js/main.js", TEXTS.get))

    assert texts["task-sheet.js"] == (
        'import{$base$dom}from"./core-1.js";\n'
        "export const $task$sheet=(()=>{\n"
        "const {el}=$base$dom;\n"
        "el();\n"
        "return{};\n})();\n"
    )


def test_bundles_run_in_the_order_of_their_modules() -> None:
    noise = random.Random(1)
    letters = {
        name: f"const {name} = '{noise.randbytes(5_000).hex()}';\n" for name in ("a", "b", "c", "d")
    }
    texts = {f"js/{name}.js": text for name, text in letters.items()}
    texts["js/main.js"] = "".join(f'import "/web/js/{name}.js";\n' for name in letters)

    first, bundles = make_bundles(Modules.reached_from("js/main.js", texts.get))

    assert first == ["core-1.js", "core-2.js"]
    assert "$b=" in bundles["core-1.js"]
    assert bundles["core-2.js"].startswith('import{}from"./core-1.js";\nexport const $c=')


def test_a_portion_is_as_large_as_a_file_may_be() -> None:
    noise = random.Random(2)
    texts = {str(number): noise.randbytes(900).hex() for number in range(60)}

    portions = list(pack(texts))

    assert [key for portion in portions for key in portion] == list(texts)
    joined = ["".join(texts[key] for key in portion) for portion in portions]
    sizes = [len(zlib.compress(text.encode(), 9)) for text in joined]
    assert all(size <= MOST_BYTES for size in sizes)
    assert all(size > MOST_BYTES - 1_100 for size in sizes[:-1])


def test_what_two_need_has_a_bundle_that_both_import() -> None:
    texts = {
        "js/main.js": 'const a = () => [import("/web/js/x.js"), import("/web/js/y.js")];\n',
        "js/x.js": 'import { s } from "/web/js/s.js";\ns();\n',
        "js/y.js": 'import { s } from "/web/js/s.js";\ns();\n',
        "js/s.js": "export function s() {}\n",
    }

    _, bundles = make_bundles(Modules.reached_from("js/main.js", texts.get))

    shared = next(name for name in bundles if name.startswith("shared-"))
    assert sorted(bundles) == sorted(["core-1.js", shared, "x.js", "y.js"])
    for name in ("x.js", "y.js"):
        assert bundles[name].startswith(f'import{{$s}}from"./{shared}";\n')
