"""A page whose service has a token asks for it, keeps it for its tab, and shows nothing before."""

from collections.abc import Iterator

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from api.access_token import TOKEN_VARIABLE
from tests.browser.places import sentence
from tests.support.process import ServiceProcess, service

pytestmark = pytest.mark.browser

TOKEN = "correct-horse-battery"
SLOW_MS = 10_000


@pytest.fixture(scope="module")
def guarded() -> Iterator[ServiceProcess]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv(TOKEN_VARIABLE, TOKEN)
        with service() as process:
            yield process


@pytest.fixture
def page(browser: Browser, guarded: ServiceProcess) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = context.new_page()
    page.goto(guarded.url)
    yield page
    context.close()


def field(page: Page) -> Locator:
    return page.get_by_label("Token", exact=True)


def give(page: Page, token: str) -> None:
    expect(field(page)).to_be_visible()
    field(page).fill(token)
    page.get_by_role("button", name="Use this token").click()


def test_the_page_asks_for_the_token_and_shows_nothing_of_the_robot_before(page: Page) -> None:
    expect(field(page)).to_be_focused()
    expect(page).to_have_title("Token needed · Pilothouse")
    expect(page.locator("header")).to_be_hidden()
    expect(page.locator("main")).to_be_hidden()
    expect(page.get_by_text("use the hardware stop")).to_be_visible()


@pytest.mark.parametrize("wrong", ["wrong", "two words", "Schlüssel", TOKEN.upper()])
def test_a_wrong_token_is_called_wrong_and_not_kept(page: Page, wrong: str) -> None:
    give(page, wrong)

    expect(page.get_by_role("alert")).to_have_text("Wrong token.")
    expect(page.locator("main")).to_be_hidden()
    assert page.evaluate("sessionStorage.length") == 0


def test_the_right_token_opens_the_page_and_the_stream(page: Page) -> None:
    give(page, "wrong")
    expect(page.get_by_role("alert")).to_be_visible()
    give(page, f" {TOKEN} ")

    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
    expect(page.get_by_text("Connected", exact=True)).to_be_visible()
    expect(field(page)).to_be_hidden()


def test_the_token_goes_with_what_the_page_asks_for(page: Page, guarded: ServiceProcess) -> None:
    give(page, TOKEN)
    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)

    page.get_by_role("radio", name="PERFORMANCE").click()

    expect(page.locator("ph-change")).to_contain_text("succeeded after", timeout=SLOW_MS)


def test_a_write_is_told_once_and_by_whom_where_details_are_wanted(page: Page) -> None:
    give(page, TOKEN)
    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
    page.get_by_role("radio", name="MODERATE").click()
    expect(page.locator("ph-change")).to_contain_text("succeeded after", timeout=SLOW_MS)
    page.get_by_role("tab", name="Log", exact=True).click()
    written = page.locator('ph-event-list [data-kind="audit.write"]')

    expect(written).to_have_count(0)
    page.get_by_role("switch", name="Show details").check()

    expect(written.first).to_contain_text("POST /systems/actuation/mode from 127.0.0.1:")
    expect(written.first).to_contain_text("answered 202")


def test_a_reload_keeps_the_token_and_nothing_else_does(
    page: Page, guarded: ServiceProcess
) -> None:
    give(page, TOKEN)
    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)

    page.reload()

    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
    assert page.evaluate("localStorage.length") == 0
    assert page.context.cookies() == []
    assert TOKEN not in page.url
    other = page.context.new_page()
    other.goto(guarded.url)
    expect(field(other)).to_be_visible()


def test_a_token_that_is_not_right_any_more_is_asked_for_again(page: Page) -> None:
    give(page, TOKEN)
    expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
    page.evaluate("sessionStorage.setItem('pilothouse-token', 'that-of-before')")

    page.reload()

    expect(field(page)).to_be_visible()
    expect(page.locator("main")).to_be_hidden()


def test_a_service_that_comes_back_with_another_token_asks_for_that_one(browser: Browser) -> None:
    context = browser.new_context()
    page = context.new_page()
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv(TOKEN_VARIABLE, TOKEN)
        with service() as before:
            page.goto(before.url)
            give(page, TOKEN)
            expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
        patched.setenv(TOKEN_VARIABLE, f"{TOKEN}-2")
        with service("--port", before.url.rpartition(":")[2]):
            expect(field(page)).to_be_visible(timeout=2 * SLOW_MS)
            give(page, f"{TOKEN}-2")
            expect(sentence(page)).to_have_text("IDLE: no task", timeout=SLOW_MS)
    context.close()
