"""How the page arrives: few files, a frame inside, and a notice when it is of another version."""

from collections.abc import Iterator

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Page, Route, WebSocketRoute, expect

from api.http.page.assembled_page import assemble, assembled_page
from api.http.page.minifier import minified
from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser

VERSION = assembled_page().version
MODULES = {
    "index.html": (
        '<!doctype html><head>\n<script type="module" src="/web/js/main.js"></script>\n</head>'
        "<body></body>"
    ),
    "js/main.js": (
        'import { label as words } from "/web/js/words.js";\n'
        'import * as numbers from "/web/js/numbers.js";\n'
        "const label = `${words(1)} ${numbers.ONE ? `and ${words(2)}` : ''}`;\n"
        "window.seen = [label];\n"
        "window.more = async () => {\n"
        '  const { count } = await import("/web/js/sheet.js");\n'
        '  await import("/web/js/drawer.js");\n'
        "  return count();\n"
        "};\n"
    ),
    "js/words.js": "export function label(n) {\n  return `no. ${n}`;\n}\n",
    "js/numbers.js": "export const ONE = 1;\n",
    "js/counter.js": "let count = 0;\nexport function next() {\n  return (count += 1);\n}\n",
    "js/sheet.js": (
        'import { next } from "/web/js/counter.js";\n'
        'import { ONE } from "/web/js/numbers.js";\n'
        "next();\nexport const count = () => next() * 10 + ONE;\n"
    ),
    "js/drawer.js": 'import { next } from "/web/js/counter.js";\nnext();\n',
}
"""Names that are used twice, an instance that two bundles share, and templates inside templates."""


@pytest.fixture
def page(browser: Browser, complaints: Complaints) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    complaints.watch(page)
    yield page
    context.close()


def test_modules_in_bundles_run_as_they_would_alone(page: Page) -> None:
    made = assemble(MODULES, minified)

    def answer(route: Route) -> None:
        name = route.request.url.rpartition("/")[2]
        file = made.files.get(name)
        body = made.head + made.foot if file is None else file.content
        kind = "text/html" if file is None else file.media_type
        route.fulfill(body=body, content_type=kind)

    page.route("http://page.test/**", answer)
    page.goto("http://page.test/")

    assert page.evaluate("window.seen") == ["no. 1 and no. 2"]
    assert page.evaluate("window.more()") == 31


def test_the_first_use_needs_few_files_and_no_source(page: Page, service: Service) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(service.url)
    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE")

    for name in assembled_page().first:
        assert f"{service.url}/web/v/{VERSION}/{name}" in asked
    assert not [url for url in asked if "/web/js/" in url or "/web/style/" in url]


def test_a_page_that_is_opened_again_loads_no_file_again(page: Page, service: Service) -> None:
    assert all(transferred(page, service))

    page.goto("about:blank")

    assert not any(transferred(page, service))


def transferred(page: Page, service: Service) -> list[int]:
    """Open the page, and return how many bytes of each of its files came over the network."""
    page.goto(service.url)
    page.wait_for_function("() => customElements.get('ph-map') !== undefined")
    sizes: list[int] = page.evaluate(
        """() => performance.getEntriesByType("resource")
            .filter(({ name }) => name.includes("/web/v/"))
            .map(({ transferSize }) => transferSize)"""
    )
    assert len(sizes) > len(assembled_page().first)
    return sizes


def test_the_state_is_shown_before_the_stream_is_connected(
    page: Page, service: Service, complaints: Complaints
) -> None:
    page.route_web_socket("**/ws*", lambda _: None)

    page.goto(service.url)

    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE: no task")
    expect(page.get_by_role("button", name="STOP", exact=True)).to_be_enabled()
    # What the page brought grows old as any other frame.
    expect(page.get_by_role("heading", level=1)).to_contain_text("No contact")
    assert complaints.messages == []


def test_the_stream_goes_on_from_the_frame_of_the_page_without_a_gap(
    page: Page, service: Service, complaints: Complaints
) -> None:
    sent: list[str] = []
    page.on("websocket", lambda socket: sent.append(socket.url))
    service.request("PATCH", "/mock/battery_level", {"value": 0.1, "publishing": True})
    expect_error(page, service)

    page.goto(service.url)

    expect(page.get_by_role("heading", level=1)).to_contain_text("ERROR")
    assert "after=" in sent[0]
    assert "epoch=" in sent[0]
    assert complaints.messages == []


def expect_error(page: Page, service: Service) -> None:
    page.wait_for_timeout(100)
    for _ in range(100):
        if service.request("GET", "/system_state")["state"] == "ERROR":
            return
        page.wait_for_timeout(100)
    pytest.fail("the battery is no error")


def test_a_page_of_another_version_asks_to_reload_and_waits_for_a_person(
    page: Page, service: Service, complaints: Complaints
) -> None:
    def change_version(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        server.on_message(
            lambda message: socket.send(str(message).replace(VERSION, "000000000000"))
        )

    notice = page.get_by_text("This page is of another version")
    page.goto(service.url)
    expect(page.get_by_role("heading", level=1)).to_contain_text("IDLE")
    expect(notice).to_be_hidden()
    page.route_web_socket("**/ws*", change_version)
    page.reload()
    expect(notice).to_be_visible()
    page.evaluate("window.isSamePage = true")
    page.wait_for_timeout(1000)
    assert page.evaluate("window.isSamePage")
    expect(page.get_by_role("button", name="STOP", exact=True)).to_be_enabled()

    with page.expect_navigation():
        page.get_by_role("button", name="Reload").click()

    assert page.evaluate("window.isSamePage") is None
    assert complaints.messages == []


def test_what_nodes_are_called_cannot_end_the_block_of_the_first_frame(
    page: Page, service: Service, complaints: Complaints
) -> None:
    reason = "</script><script>window.isTaken = true</script><!--"
    service.request("PUT", "/holds/operator", {"reason": reason})

    page.goto(service.url)

    expect(page.get_by_text(reason).first).to_be_attached()
    assert page.evaluate("window.isTaken") is None
    assert complaints.messages == []
