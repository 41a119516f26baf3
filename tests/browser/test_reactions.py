"""The list of reactions, as an operator reads it and uses it."""

import re
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")

from playwright.sync_api import Locator, Page, expect

from tests.browser.station import Service, serving

pytestmark = pytest.mark.browser

MODEL = """\
carrier:
  ros__parameters:
    type: system
    modes:
      __DEFAULT__: {drive: active}
      SLOW: {drive: active.SLOW}
    reactions:
      LIMP: {when: "temperature > 40", action: mode, target: active.SLOW, at_most: 100}
      HALT: {when: "temperature > 45", action: hold, until: acknowledged}
drive:
  ros__parameters:
    type: node
    modes:
      __DEFAULT__: {ros__parameters: {speed: 0.9}}
      SLOW: {ros__parameters: {speed: 0.1}}
"""


@pytest.fixture(scope="module")
def running_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Return a carrier that slows down when it is warm."""
    folder = tmp_path_factory.mktemp("reactions")
    model = folder / "model.yaml"
    model.write_text(MODEL)
    with serving(folder, (str(model),)) as service:
        yield service


@pytest.fixture
def service(running_service: Service) -> Service:
    running_service.make_healthy()
    return running_service


def section(page: Page) -> Locator:
    return page.locator("ph-why")


def line(page: Page, name: str) -> Locator:
    return section(page).locator("ph-reaction").filter(has_text=name)


def warm_up(service: Service, value: float) -> None:
    service.request("POST", "/signals/temperature", {"value": value})


def test_reactions_that_wait_are_folded(desktop: Page, service: Service) -> None:
    expect(section(desktop)).to_contain_text("2 waiting")
    expect(line(desktop, "carrier.LIMP")).not_to_be_visible()


def test_one_that_acts_says_what_it_waits_for(desktop: Page, service: Service) -> None:
    service.request("POST", "/systems/carrier/mode", {"mode": "__DEFAULT__"})
    warm_up(service, 42.0)

    expect(line(desktop, "carrier.LIMP")).to_contain_text("acts")
    expect(line(desktop, "carrier.LIMP")).to_contain_text("Waits for an end of: temperature > 40")
    expect(section(desktop).locator("h2")).to_contain_text("1 acting")


def test_one_that_acts_says_why_when_it_is_opened(desktop: Page, service: Service) -> None:
    service.request("POST", "/systems/carrier/mode", {"mode": "__DEFAULT__"})
    warm_up(service, 42.0)
    expect(line(desktop, "carrier.LIMP").locator(".reason-tree")).to_have_count(0)
    line(desktop, "carrier.LIMP").locator("summary").click()
    expect(line(desktop, "carrier.LIMP").locator(".reason-tree")).to_contain_text("42")


def test_the_reactions_of_a_part_are_with_the_part(desktop: Page, service: Service) -> None:
    of_part = desktop.locator("ph-part-panel ph-reaction")
    expect(of_part).to_have_count(2)
    desktop.get_by_role("treeitem").filter(has_text="drive").last.click()
    expect(of_part).to_have_count(0)


def test_a_hold_of_a_reaction_has_no_release_and_is_acknowledged(
    desktop: Page, service: Service
) -> None:
    warm_up(service, 48.0)
    desktop.get_by_role("button", name=re.compile(r"^\d holds?$")).click()
    holds = desktop.get_by_role("listitem").filter(has_text="reaction:HALT")
    expect(holds).to_contain_text("carrier: temperature > 45")
    expect(desktop.get_by_role("button", name="Release reaction:HALT")).to_have_count(0)
    warm_up(service, 30.0)
    desktop.keyboard.press("Escape")
    button = line(desktop, "carrier.HALT").get_by_role("button", name="Acknowledge (hold)")
    button.click(delay=1200)
    expect(desktop.get_by_role("button", name=re.compile(r"^\d holds?$"))).to_have_count(0)
    expect(desktop.get_by_role("heading", level=1)).to_have_text("IDLE: no task")


def test_a_reaction_is_armed_by_a_long_press(desktop: Page, service: Service) -> None:
    section(desktop).locator("summary").filter(has_text="2 waiting").click()
    line(desktop, "carrier.LIMP").locator("summary").click()
    line(desktop, "carrier.LIMP").locator("select").select_option("disarmed")
    line(desktop, "carrier.LIMP").get_by_role("button", name="Set (hold)").click(delay=1200)
    expect(section(desktop)).to_contain_text("1 waiting")
    armed: Any = service.request("GET", "/reactions")
    assert [item["arm"] for item in armed["items"]] == ["disarmed", "active"]
