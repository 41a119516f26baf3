"""A page in a browser of its own, and what its processes use."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import psutil
from playwright.sync_api import Browser, CDPSession, Page, Playwright, sync_playwright

from tests.browser.station import CHROMIUM, CHROMIUM_ARGUMENTS

_DRAWING = ("--type=renderer", "--type=gpu-process")
_WATCH = """
const watch = () => {
  const word = document.querySelector("h1")?.textContent ?? "";
  const stop = document.querySelector("ph-stop-button button");
  const rows = document.querySelectorAll("[role=treeitem]").length;
  const isUsable = word && !/Connecting|contact/.test(word) && stop && !stop.disabled;
  if (isUsable) window.usableMs ??= performance.now();
  if (isUsable && rows) window.drawnMs ??= performance.now();
  if (window.drawnMs === undefined) requestAnimationFrame(watch);
};
requestAnimationFrame(watch);
"""
"""Notes in the page when its header tells the state, STOP can be pressed, and parts are listed."""

_HEARD_MS = """
(selector) => new Promise((resolve) => {
  const button = document.querySelector(selector);
  const shown = () => button.closest("section, header, div").outerHTML;
  const before = shown();
  let pressed = null;
  button.addEventListener("click", () => (pressed = performance.now()), { capture: true });
  const look = () => {
    if (pressed !== null && shown() !== before) resolve(performance.now() - pressed);
    else requestAnimationFrame(look);
  };
  look();
  button.click();
})
"""


@dataclass(frozen=True, slots=True)
class OpenedPage:
    """The page, just opened."""

    page: Page
    devtools: CDPSession
    drawing: tuple[psutil.Process, ...]
    """The renderer and the GPU process."""
    frames: list[object]
    """What has come over the stream."""

    def usable_s(self) -> float:
        """Return how long after the navigation the state was shown and STOP could be pressed."""
        return self._noted_s("usableMs")

    def drawn_s(self) -> float:
        """Return how long after the navigation the parts were listed as well."""
        return self._noted_s("drawnMs")

    def _noted_s(self, name: str) -> float:
        handle = self.page.wait_for_function(f"() => window.{name}", timeout=60_000)
        return float(handle.json_value()) / 1000

    def heard_s(self, selector: str) -> float:
        """Press a button, and return how long it took until that could be seen."""
        return float(self.page.evaluate(_HEARD_MS, selector)) / 1000

    def cost(self, seconds: float) -> dict[str, float]:
        """Return what drawing takes from now on, as the share of a core, and of how many frames."""
        self.frames.clear()
        begin, before = time.perf_counter(), self._cpu_s()
        self.page.wait_for_timeout(1000 * seconds)
        used_s, passed_s = self._cpu_s() - before, time.perf_counter() - begin
        return {
            "CPU_percent": round(100 * used_s / passed_s, 1),
            "frames_per_s": round(len(self.frames) / passed_s, 1),
        }

    def heap_mb(self) -> float:
        """Return the memory of scripts that is still in use."""
        self.devtools.send("HeapProfiler.collectGarbage")
        metrics = self.devtools.send("Performance.getMetrics")["metrics"]
        used = next(each["value"] for each in metrics if each["name"] == "JSHeapUsedSize")
        return float(used) / 1e6

    def _cpu_s(self) -> float:
        times = [process.cpu_times() for process in self.drawing]
        return sum(each.user + each.system for each in times)


@contextmanager
def opened(url: str) -> Iterator[OpenedPage]:
    """Open the page in a browser that knows nothing yet, as long as the context lasts."""
    with sync_playwright() as playwright, _browser(playwright) as browser:
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.add_init_script(_WATCH)
        frames: list[object] = []
        page.on(
            "websocket",
            lambda socket: socket.on("framereceived", lambda frame: frames.append(frame)),
        )
        page.goto(url, wait_until="commit")
        devtools = page.context.new_cdp_session(page)
        devtools.send("Performance.enable")
        yield OpenedPage(page, devtools, tuple(_drawing()), frames)


@contextmanager
def _browser(playwright: Playwright) -> Iterator[Browser]:
    browser = playwright.chromium.launch(executable_path=str(CHROMIUM), args=CHROMIUM_ARGUMENTS)
    try:
        yield browser
    finally:
        browser.close()


def _drawing() -> Iterator[psutil.Process]:
    for process in psutil.Process().children(recursive=True):
        if any(kind in process.cmdline() for kind in _DRAWING):
            yield process
