"""A real Chromium, and a real service as a process of its own that a test may kill."""

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from tests.browser.station import CHROMIUM, CHROMIUM_ARGUMENTS, Complaints, Service, serving

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

EXPECTED_WITHIN_MS = 15_000


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with serving(tmp_path_factory.mktemp("service")) as service:
        yield service


@pytest.fixture
def service(running_service: Service) -> Service:
    running_service.make_healthy()
    return running_service


# Of a module, not of more: while playwright runs, no coroutine of another test can.
@pytest.fixture(scope="module")
def browser() -> Iterator["Browser"]:
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if not CHROMIUM.exists():
        pytest.skip(f"there is no {CHROMIUM}")
    with sync_api.sync_playwright() as playwright:
        # Pages are drawn without a GPU, beside other tests: what is waited for may take its time.
        sync_api.expect.set_options(timeout=EXPECTED_WITHIN_MS)
        browser = playwright.chromium.launch(executable_path=str(CHROMIUM), args=CHROMIUM_ARGUMENTS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def page(browser: "Browser", running_service: Service) -> Iterator["Page"]:
    """Return a page in which modules of it are imported and called."""
    page = browser.new_page()
    page.goto(running_service.url)
    yield page
    page.close()


@pytest.fixture
def complaints() -> Complaints:
    return Complaints()


@pytest.fixture
def desktop(browser: "Browser", service: Service, complaints: Complaints) -> Iterator["Page"]:
    yield from _opened(browser, service, complaints, width=1280, height=800)


@pytest.fixture
def phone(browser: "Browser", service: Service, complaints: Complaints) -> Iterator["Page"]:
    yield from _opened(browser, service, complaints, width=360, height=640)


def _opened(
    browser: "Browser", service: Service, complaints: Complaints, width: int, height: int
) -> Iterator["Page"]:
    from playwright.sync_api import expect

    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    complaints.watch(page)
    page.goto(service.url)
    # A task that was aborted is told until there is another one.
    expect(page.get_by_role("heading", level=1)).to_contain_text(re.compile("IDLE|ABORTED"))
    yield page
    context.close()
