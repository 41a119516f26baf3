"""Pictures of the page in each state of a robot, to be looked at.

Run `python -m tests.browser.states FOLDER [NAME ...]`: for each state (or those named) four
pictures, desktop and phone, light and dark. Those of the documents are made by `make pictures`.
"""

import argparse
import json
import re
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal

from playwright.sync_api import Browser, Page, WebSocketRoute, sync_playwright

from tests.browser.earlier_runs import tell_earlier_runs
from tests.browser.robots import (
    crowded_robot,
    guarded_robot,
    large_robot,
    many_signals_robot,
    troubled_robot,
)
from tests.browser.station import CHROMIUM, CHROMIUM_ARGUMENTS, Service, serving
from tests.support.monitor import device, this_device
from tests.support.shared import PROJECT

SCREENS = {"desktop": (1440, 900), "phone": (360, 640)}
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")
UTM = (303_628.48, 3_900_696.88)
LOST_MS = 3600

Act = Callable[[Page, Service], None]
MOBILE = PROJECT / "examples" / "mobile_robot"
Robot = Literal[
    "example",
    "troubled",
    "large",
    "crowded",
    "guarded",
    "guarded_failing",
    "mobile",
    "many_signals",
]
MANIPULATION = "/systems/mobile_manipulation"


def post(service: Service, path: str, body: object) -> None:
    service.request("POST", path, body)


def drive(service: Service, speed_mps: float = 2.8) -> None:
    """Start a long task where the vehicle stands, and let it come up to speed."""
    pose = service.pose()
    waypoints = [{**pose, "x_m": pose["x_m"] + 2.0 * n, "yaw_rad": 0.0} for n in range(60)]
    post(service, "/tasks", {"waypoints": waypoints, "speed_mps": speed_mps})
    time.sleep(4)


def show_part(page: Page, name: str) -> None:
    """Show a part: on a phone it opens in place of the list."""
    page.evaluate(
        "(detail) => document.dispatchEvent(new CustomEvent('ph-select', { detail }))", name
    )
    page.locator("ph-part-panel h2").filter(has_text=name).wait_for()


def running(_: Page, service: Service) -> None:
    drive(service)


def three_holds(_: Page, service: Service) -> None:
    drive(service)
    for owner, why in (("gate", "the gate is shut"), ("operator", ""), ("loading", "a pallet")):
        service.request("PUT", f"/holds/{owner}", {"reason": why})
    time.sleep(3)


def dead_node(page: Page, service: Service) -> None:
    post(service, "/systems/actuation/mode", {"mode": "PERFORMANCE"})
    page.wait_for_timeout(5000)
    select(page, "manipulator")


def stopped(_: Page, service: Service) -> None:
    drive(service)
    stop = {"engaged": True, "reason": "smoke in hall 3"}
    service.request("PUT", "/emergency_stop", stop)
    time.sleep(1)


def guarded(page: Page, service: Service) -> None:
    """A mode that cannot be entered, with all reasons, and a part that a dead node keeps away."""
    show_part(page, "mobile_manipulation")
    post(service, f"{MANIPULATION}/mode", {"mode": "CAREFUL"})
    page.locator(".change-status").filter(has_text="failed").wait_for()
    service.request("PATCH", "/mock/battery_level", {"value": 0.21})
    service.request("PATCH", "/mock/temperature", {"value": 55})
    page.locator(".mode").filter(has_text="MANIPULATE").locator("summary").click()
    page.locator("ph-part-why summary").click()
    page.locator(".root").nth(1).scroll_into_view_if_needed()


def plan(page: Page, service: Service) -> None:
    show_part(page, "mobile_manipulation")
    post(service, f"{MANIPULATION}/mode?wait=15", {"mode": "CAREFUL"})
    post(service, f"{MANIPULATION}/state?wait=15", {"transition": "cleanup"})
    page.get_by_label("Plan first").check()
    page.get_by_role("radio", name="MANIPULATE").click()
    page.get_by_role("button", name="Apply").scroll_into_view_if_needed()


def displaced(page: Page, service: Service) -> None:
    """A fallback in place of the mode that was requested, and why."""
    show_part(page, "mobile_manipulation")
    post(service, f"{MANIPULATION}/mode?wait=15", {"mode": "MANIPULATE"})
    service.request("PATCH", "/mock/temperature", {"value": 55})
    page.locator("ph-part-why summary").click()
    page.locator("ph-part-why .root").wait_for()


def rolled_back(page: Page, service: Service) -> None:
    show_part(page, "mobile_manipulation")
    post(service, f"{MANIPULATION}/mode", {"mode": "MANIPULATE"})
    page.locator(".change-status").filter(has_text="rolled back").wait_for()
    page.locator(".change").scroll_into_view_if_needed()


def waiting(page: Page, service: Service) -> None:
    show_part(page, "mobile_manipulation")
    service.request("PATCH", "/mock/battery_level", {"value": 0.21})
    page.get_by_text("Battery is 0.21").first.wait_for()
    post(service, f"{MANIPULATION}/mode", {"mode": "MANIPULATE", "wait_for_s": 600})
    page.get_by_role("button", name="Stop waiting").scroll_into_view_if_needed()


def acknowledge(_: Page, service: Service) -> None:
    for pressed in (True, False):
        post(service, "/signals/estop", {"value": pressed})
        time.sleep(0.5)


def errors(page: Page, service: Service) -> None:
    """An error with what follows from it, one that comes and goes, one that is over, a shelf."""
    post(service, "/systems/actuation/mode", {"mode": "PERFORMANCE"})
    for value in (60, 30) * 3:
        service.request("PATCH", "/mock/temperature", {"value": value})
        time.sleep(0.4)
    acknowledge(page, service)
    known = {"for_s": 1800, "reason": "the scale is being calibrated"}
    service.request("PUT", "/errors/OVERLOAD/shelf", known)
    page.wait_for_timeout(5000)


def errors_shelving(page: Page, service: Service) -> None:
    errors(page, service)
    page.get_by_role("button", name="Shelve …").first.click()
    page.locator("ph-shelve-form").first.scroll_into_view_if_needed()


def reacting(page: Page, service: Service) -> None:
    """Nothing sends scans or maps: the robot creeps, and what it would do besides is told."""
    post(service, "/systems/rover/state?wait=15", {"transition": "activate"})
    for _ in range(8):
        post(service, "/signals", {"scan": 360.0, "map_age_s": 2.5})
        time.sleep(0.1)
    post(service, "/nodes/left_drive/errors/FAULT", {"active": True, "message": "overcurrent"})
    page.wait_for_timeout(2500)


def reactions_seen(page: Page, service: Service) -> None:
    reacting(page, service)
    page.locator("ph-why ph-reaction-list").scroll_into_view_if_needed()


def low_battery(_: Page, service: Service) -> None:
    service.request("PATCH", "/mock/battery_level", {"value": 0.314})
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})


def show_signals(page: Page) -> None:
    page.evaluate("document.dispatchEvent(new CustomEvent('ph-tab', { detail: 'signals' }))")


def signals_pending(page: Page, service: Service) -> None:
    """An error, one that is coming and one that is stale; the first is open to its history."""
    show_signals(page)
    service.request("PATCH", "/mock/gps_accuracy", {"value": 250})
    service.request("PATCH", "/mock/signal_strength", {"publishing": False})
    for value in (44, 49, 53, 58, 61):
        service.request("PATCH", "/mock/temperature", {"value": value})
        page.wait_for_timeout(1500)
    row = page.locator("ph-signal-list ph-signal-row").filter(has_text="Temperature")
    row.get_by_role("button").first.click()
    row.get_by_role("button", name="1 min", exact=True).click()
    row.locator(".chart-line[d^=M]").wait_for(state="attached")


def signals_200(page: Page, service: Service) -> None:
    show_signals(page)
    for number in range(0, 200, 3):
        value = 90 if number in (42, 141) else 30 + number % 40
        post(service, f"/signals/motor_{number:03}_temperature", {"value": value})
    page.wait_for_timeout(2500)


def what_if(page: Page, service: Service) -> None:
    """A low battery and a node that dies, on a copy of a robot that drives."""
    drive(service)
    page.evaluate("document.dispatchEvent(new CustomEvent('ph-what-if', { detail: {} }))")
    drawer = page.locator("ph-what-if")
    drawer.locator(".what-if-outcome").wait_for(timeout=30_000)
    drawer.get_by_role("slider", name="Simulated Battery: set").fill("0.42")
    drawer.get_by_label("After how many seconds").fill("12")
    drawer.get_by_role("button", name="Add", exact=True).click()
    drawer.get_by_text("is unreachable").first.wait_for()


def no_contact(page: Page, service: Service) -> None:
    drive(service)
    service.kill()
    page.wait_for_timeout(LOST_MS)


def restarted(page: Page, service: Service) -> None:
    drive(service)
    service.kill()
    service.start()
    page.locator(".notice").wait_for()


def storage(page: Page, service: Service) -> None:
    """What a person may do while storage fails, with as much around it as there can be."""
    drive(service)
    acknowledge(page, service)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke in hall 3"})
    service.break_storage()
    page.locator(".storage").wait_for()


def storage_alone(page: Page, service: Service) -> None:
    drive(service)
    service.break_storage()
    page.locator(".storage").wait_for()


def open_form(page: Page) -> None:
    page.get_by_role("button", name="New task").click()
    page.get_by_role("button", name="Drive the example loop").wait_for()


def new_task(page: Page, _: Service) -> None:
    open_form(page)


def choose(page: Page, table: bytes) -> None:
    open_form(page)
    file: Any = {"name": "field.csv", "mimeType": "text/csv", "buffer": table}
    page.get_by_label("Choose a CSV").set_input_files(file)


def task_preview(page: Page, service: Service) -> None:
    choose(page, service.track_ahead(30, scans=True))
    page.get_by_role("heading", name="Preview").wait_for()


def rejected(page: Page, _: Service) -> None:
    choose(page, b"x;y;yaw\n0;0;0\n1;2;zwei\n")
    page.locator("ph-task-form").get_by_role("alert").scroll_into_view_if_needed()


def sending(page: Page, _: Service) -> None:
    show_part(page, "actuation")
    page.route("**/mode", lambda _: None)
    page.get_by_role("radio", name="PERFORMANCE").click()


def far_down(page: Page, _: Service) -> None:
    select(page, "node_090")


def show_parts(page: Page) -> None:
    """Go to the tab of parts, where parts do not stand beside everything else."""
    tab = page.get_by_role("tab", name="Parts")
    if tab.is_visible():
        tab.click()


def select(page: Page, part: str) -> None:
    show_parts(page)
    # Only rows that can be seen are drawn.
    page.get_by_role("searchbox", name="Filter parts by name").fill(part)
    page.get_by_role("treeitem", name=re.compile(f"^{part} ")).last.click()


def parts_300(page: Page, service: Service) -> None:
    """Two nodes are dead, one failed, one was made slow; one of the areas is open."""
    change = service.request("POST", "/systems/carrier/mode", {"mode": "__DEFAULT__"})["id"]
    while service.request("GET", f"/changes/{change}")["status"] == "running":
        time.sleep(0.2)
    slowed = "perception/unit_03/camera_wheel_003"
    service.request("PATCH", f"/nodes/{slowed}/parameters", {"rate": 2})
    show_parts(page)
    for system in ("perception", "perception_unit_03"):
        page.get_by_role("treeitem", name=re.compile(f"^{system} ")).locator(".twist").click()
    page.wait_for_timeout(1000)


def parts_attention(page: Page, service: Service) -> None:
    parts_300(page, service)
    page.locator(".choice").filter(has_text="Attention").click()


def parts_filtered(page: Page, service: Service) -> None:
    parts_300(page, service)
    page.get_by_role("searchbox", name="Filter parts by name").fill("unit_03 camera")


def patched(change: Callable[[dict[str, Any]], None]) -> Act:
    """Return what shows a state that is hard to bring about: its frames are changed on the way."""

    def act(page: Page, _: Service) -> None:
        def between(browser: WebSocketRoute) -> None:
            server = browser.connect_to_server()

            def pass_on(message: str | bytes) -> None:
                frame = json.loads(message)
                if frame["type"] == "state":
                    change(frame)
                browser.send(json.dumps(frame))

            server.on_message(pass_on)

        page.route_web_socket("**/ws*", between)
        page.reload()

    return act


def aborted(frame: dict[str, Any]) -> None:
    at = frame["at"]
    ended = {"status": "ABORTED", "reason": "3.2 m from the path for 1 s", "ended_at": at}
    whole = {"id": "t7", "controller": "stanley", "speed_mps": 2.8, "waypoint_count": 66}
    way = {"length_m": 799.0, "target_index": 40, "progress": 0.42, "distance_m": 336.0}
    frame["task"] = {**whole, **way, **ended, "cross_track_error_m": 3.2, "created_at": at}


def still_moving(frame: dict[str, Any]) -> None:
    message = "the vehicle still moves at 1.1 m/s, 34 s after the stop"
    reasons = [{"code": "STILL_MOVING", "message": message, "path": ["vehicle"]}]
    reasons.append({"code": "ESTOP", "message": "emergency stop is engaged", "path": ["estop"]})
    frame["system_state"] |= {"state": "ERROR", "errors": ["ESTOP"], "reasons": reasons}
    why = {"by": "anna", "reason": "smoke in hall 3", "since_at": frame["at"]}
    frame["emergency_stop"] = {"engaged": True, **why, "standstill_at": None}
    if "vehicle" in frame:
        frame["vehicle"]["speed_mps"] = 1.1


def on_devices(lost: bool, stop: bool = False) -> Act:
    """Return what shows the example robot with a device for each node; one of them may be lost."""

    def act(page: Page, service: Service) -> None:
        post(service, "/systems/actuation/mode?wait=15", {"mode": "PERFORMANCE"})
        if stop:
            stopped(page, service)
        items = [*service.request("GET", "/systems")["items"]]
        items += service.request("GET", "/nodes")["items"]
        page.locator("h1").filter(has_text=re.compile("IDLE|ERROR")).wait_for()
        told = told_of_devices({item["name"]: item for item in items}, lost=lost)
        patched(lambda frame: frame.update(told))(page, service)
        show_part(page, "manipulator")
        page.wait_for_timeout(2500)

    return act


def told_of_devices(parts: dict[str, Any], *, lost: bool) -> dict[str, Any]:
    """Return members of frames."""
    parts["drive_base"]["device"], parts["manipulator"]["device"] = "base", "arm"
    devices = {"base": device("base"), "arm": device("arm", "lost" if lost else "connected")}
    for name, node in (("base", "drive_base"), ("arm", "manipulator")):
        offline = {"after_s": 2.0, "target": {node: "inactive"}, "reactions": name == "base"}
        devices[name] = {**devices[name], "parts": [node], "offline": offline}
    if lost:
        at = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
        why = "nothing was heard for 1.5 s"
        devices["arm"] = {**devices["arm"], "since_at": at, "heard_at": at, "reason": why}
        arm = parts["manipulator"]
        arm |= {"last_known": {"state": "active", "mode": "STRONG"}, "reachable": False}
        for name, reason in (("manipulator", None), ("actuation", "manipulator is unreachable")):
            gone = {"state": "unknown", "mode": None, "reason": reason, "undecidable": True}
            parts[name]["actual"] |= gone
            parts[name] |= {"converged": False, "deviation_since_at": at}
            parts[name]["deviation_reason"] = "manipulator is unreachable"
    return {"parts": parts, "devices": devices}


def on_a_device(lead: str) -> Act:
    """Return what shows the page of a device."""
    return patched(lambda frame: frame.update(this_device=this_device("arm", lead)))


def earlier_events(page: Page, service: Service) -> None:
    """The end of the list after two restarts, the earlier of them after a kill."""
    del service
    tell_earlier_runs(page)
    page.get_by_role("tab", name="Log").click()
    button = page.get_by_role("button", name="Earlier")
    for _ in range(2):
        button.click()
        page.wait_for_timeout(500)
    button.scroll_into_view_if_needed()
    page.locator("li.restart").last.scroll_into_view_if_needed()


def timeline(page: Page, service: Service) -> None:
    """Some minutes of work with all that a timeline shows, a restart among it."""
    post(service, "/systems/actuation/mode?wait=15", {"mode": "MODERATE"})
    drive(service)
    service.request("PUT", "/holds/gate", {"reason": "the gate is shut"})
    time.sleep(3)
    service.request("DELETE", "/holds/gate")
    for value in (0.3, 0.9) * 4:
        service.request("PATCH", "/mock/battery_level", {"value": value})
        time.sleep(0.4)
    service.kill()
    time.sleep(5)
    service.start()
    post(service, "/systems/actuation/mode?wait=15", {"mode": "PERFORMANCE"})
    service.request("PATCH", "/mock/temperature", {"value": 70})
    time.sleep(4)
    service.request("PUT", "/emergency_stop", {"engaged": True, "reason": "smoke in hall 3"})
    time.sleep(4)
    service.request("PUT", "/emergency_stop", {"engaged": False})
    service.request("PATCH", "/mock/temperature", {"value": 30})
    page.wait_for_timeout(6000)
    if page.viewport_size == {"width": 360, "height": 640}:
        page.get_by_role("tab", name="Log").click()
    page.get_by_role("button", name="1 min", exact=True).click()
    page.wait_for_timeout(1500)


def timeline_pinned(page: Page, service: Service) -> None:
    timeline(page, service)
    canvas = page.get_by_role("slider", name="Timeline")
    box = canvas.bounding_box()
    assert box is not None
    canvas.click(position={"x": 0.84 * box["width"], "y": 30})
    page.get_by_text("Panels show").wait_for()


def in_utm(frame: dict[str, Any]) -> None:
    if "vehicle" in frame and frame["vehicle"]["pose"]:
        frame["vehicle"]["pose"] |= {"x_m": UTM[0], "y_m": UTM[1], "yaw_rad": 0.6}


STATES: dict[str, tuple[Robot, Act]] = {
    "idle": ("example", lambda *_: None),
    "running": ("example", running),
    "three_holds": ("example", three_holds),
    "dead_node": ("troubled", dead_node),
    "aborted": ("example", patched(aborted)),
    "stopped": ("example", stopped),
    "still_moving": ("example", patched(still_moving)),
    "guarded": ("guarded_failing", guarded),
    "plan": ("guarded", plan),
    "displaced": ("guarded", displaced),
    "rolled_back": ("guarded_failing", rolled_back),
    "waiting": ("guarded", waiting),
    "acknowledge": ("troubled", acknowledge),
    "errors": ("troubled", errors),
    "errors_shelving": ("troubled", errors_shelving),
    "reacting": ("mobile", reacting),
    "reactions": ("mobile", reactions_seen),
    "low_battery": ("example", low_battery),
    "signals_pending": ("example", signals_pending),
    "signals_200": ("many_signals", signals_200),
    "what_if": ("example", what_if),
    "new_task": ("example", new_task),
    "task_preview": ("example", task_preview),
    "rejected": ("example", rejected),
    "sending": ("example", sending),
    "far_down": ("large", far_down),
    "parts_300": ("crowded", parts_300),
    "attention": ("crowded", parts_attention),
    "parts_filtered": ("crowded", parts_filtered),
    "devices": ("example", on_devices(lost=False)),
    "device_lost": ("example", on_devices(lost=True)),
    "device_lost_stopped": ("example", on_devices(lost=True, stop=True)),
    "device_itself": ("example", on_a_device("supervisor")),
    "device_cut_off": ("example", on_a_device("device")),
    "earlier_events": ("example", earlier_events),
    "timeline": ("example", timeline),
    "timeline_pinned": ("example", timeline_pinned),
    "utm": ("example", patched(in_utm)),
    "forced_colors": ("example", stopped),
    "no_contact": ("example", no_contact),
    "restarted": ("example", restarted),
    "storage": ("troubled", storage),
    "storage_alone": ("example", storage_alone),
}


@contextmanager
def running_robot(kind: Robot) -> Iterator[Service]:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files: dict[Robot, tuple[str, ...]] = {
            "example": (),
            "troubled": troubled_robot(folder),
            "large": large_robot(folder),
            "crowded": crowded_robot(folder, faulty=True),
            "guarded": guarded_robot(folder),
            "many_signals": many_signals_robot(folder),
            "mobile": (str(MOBILE / "model.yaml"), "--robot", str(MOBILE / "robot.yaml")),
            "guarded_failing": guarded_robot(folder, "fail"),
        }
        with serving(folder, files[kind], keeps=True) as service:
            yield service


def shoot(browser: Browser, folder: Path, name: str, screen: str) -> None:
    """Bring the state about on a robot of its own, and take its pictures in both schemes."""
    kind, act = STATES[name]
    width, height = SCREENS[screen]
    with running_robot(kind) as service:
        page = browser.new_page(
            viewport={"width": width, "height": height},
            has_touch=screen == "phone",
            forced_colors="active" if name == "forced_colors" else "none",
        )
        page.goto(service.url)
        page.locator("ph-part-panel h2").filter(has_text=re.compile(".")).wait_for(state="attached")
        act(page, service)
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            page.wait_for_timeout(900)
            page.screenshot(path=folder / f"{name}-{screen}-{scheme}.png")
        page.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(STATES))
    arguments = parser.parse_args()
    with sync_playwright() as playwright:
        chromium = playwright.chromium
        browser = chromium.launch(executable_path=str(CHROMIUM), args=CHROMIUM_ARGUMENTS)
        arguments.folder.mkdir(parents=True, exist_ok=True)
        for name in arguments.names or STATES:
            for screen in SCREENS:
                shoot(browser, arguments.folder, name, screen)


if __name__ == "__main__":
    main()
