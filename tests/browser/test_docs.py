"""The page that shows the interface, in a real browser that reaches nothing but the robot."""

from collections.abc import Iterator

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Browser, Locator, Page, expect

from tests.browser.station import Complaints, Service

pytestmark = pytest.mark.browser


@pytest.fixture(params=[(1440, 900), (360, 640)], ids=["desktop", "phone"])
def docs(
    request: pytest.FixtureRequest, browser: Browser, service: Service, complaints: Complaints
) -> Iterator[Page]:
    width, height = request.param
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    complaints.watch(page)
    page.goto(f"{service.url}/docs")
    expect(operation(page, "POST", "/systems/{part}/mode")).to_be_visible()
    yield page
    context.close()


def operation(page: Page, method: str, path: str) -> Locator:
    listed = page.locator(".opblock")
    of_path = listed.filter(has=page.locator(f'[data-path="{path}"]'))
    return of_path.filter(has=page.get_by_text(method, exact=True))


def test_everything_is_shown_and_nothing_is_fetched_from_elsewhere(
    browser: Browser, service: Service, complaints: Complaints
) -> None:
    context = browser.new_context()
    page = context.new_page()
    complaints.watch(page)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))

    page.goto(f"{service.url}/docs")
    expect(page.locator(".opblock")).not_to_have_count(0)
    expect(page.get_by_role("heading", name="The stream: WS /ws")).to_be_visible()
    context.close()

    elsewhere = [url for url in asked if not url.startswith((f"{service.url}/", "data:"))]
    assert elsewhere == []
    assert complaints.messages == []


def test_an_operation_is_tried_with_what_the_example_fills_in(
    docs: Page, service: Service, complaints: Complaints
) -> None:
    tried = operation(docs, "POST", "/signals/{signal}")
    tried.locator(".opblock-summary-control").click()
    tried.get_by_role("button", name="Try it out").click()

    expect(tried.get_by_placeholder("signal")).to_have_value("battery_level")
    tried.get_by_role("button", name="Execute").click()
    answer = tried.locator(".live-responses-table")
    expect(answer.locator(".response-col_status").last).to_have_text("200")

    expect(answer).to_contain_text("BATTERY_LOW")
    assert service.request("GET", "/signals/battery_level")["value"] == 0.42
    assert complaints.messages == []


def test_the_stream_is_told_with_its_examples(docs: Page, complaints: Complaints) -> None:
    stream = docs.get_by_role("region", name="The stream: WS /ws")
    expect(stream.get_by_role("heading", name="hello to the client")).to_be_visible()
    expect(stream.get_by_role("heading", name="reading from the client")).to_be_visible()

    example = stream.get_by_role("group").filter(has_text="Example: What has changed")
    example.get_by_text("Example: ").click()

    expect(example.get_by_text('"type": "state"')).to_be_visible()
    assert complaints.messages == []


def test_the_page_is_not_wider_than_the_screen(docs: Page) -> None:
    expect(docs.get_by_role("heading", name="The stream: WS /ws")).to_be_visible()

    width = docs.evaluate("document.documentElement.scrollWidth - window.innerWidth")
    assert width <= 0
