"""What a browser shows: pictures that move when played, and nothing fetched.

The browser is Debian's Chromium, driven by Playwright, with OpenGL in software.
"""

from __future__ import annotations

import importlib
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image

from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.visualization.clearance import clearance_curve
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.page import write_page
from mmplan.visualization.search import searches

# Where this is set, nothing may be skipped for want of a browser.
NO_SKIP = "MMPLAN_NO_SKIP" in os.environ
api = (
    importlib.import_module("playwright.sync_api")
    if NO_SKIP
    else pytest.importorskip("playwright.sync_api", reason="no Playwright")
)

CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium")
FLAGS = (
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-quic",
)
WIDTH, HEIGHT = 640, 400
PATIENCE = 120.0  # s
# A motion changes at least this share of the pixels by this much of 255.
SHARE, CHANGE = 0.003, 24

pytestmark = pytest.mark.skipif(
    CHROMIUM is None and not NO_SKIP,
    reason="there is no browser: apt-get install chromium",
)


@dataclass
class Tab:
    """One page in the browser, and what it did that it should not."""

    page: api.Page
    folder: Path
    requests: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def picture(self) -> np.ndarray:
        path = self.folder / f"{time.monotonic_ns()}.png"
        self.page.screenshot(path=path)
        with Image.open(path) as image:
            return np.asarray(image.convert("RGB")).astype(int)

    def requests_elsewhere(self, *origins: str) -> list[str]:
        """What was asked for at other places than `origins` (scheme and host)."""
        return [url for url in self.requests if origin(url) not in origins]


def origin(url: str) -> str:
    if url.startswith("blob:"):
        return origin(url[5:])
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.netloc}"


def view_of(picture: np.ndarray) -> np.ndarray:
    """The part of a picture that neither panels nor notices cover."""
    return picture[170:265, :310]


def moves(pictures: list[np.ndarray]) -> bool:
    """Whether a recording moves: whether any two pictures in a row differ."""
    views = [view_of(picture) for picture in pictures]
    return any(
        (np.abs(a - b).max(axis=2) > CHANGE).mean() > SHARE for a, b in pairwise(views)
    )


def recording(tab: Tab, seconds: float) -> list[np.ndarray]:
    """Pictures of the next seconds, at least two, until they move."""
    pictures = [tab.picture()]
    end = time.monotonic() + seconds
    while len(pictures) < 2 or (time.monotonic() < end and not moves(pictures)):
        time.sleep(0.3)
        pictures.append(tab.picture())
    return pictures


@pytest.fixture(scope="module")
def browser() -> Iterator[api.Browser]:
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=CHROMIUM, args=list(FLAGS), timeout=1000 * PATIENCE
        )
        yield browser
        browser.close()


@pytest.fixture
def tab(browser: api.Browser, tmp_path: Path) -> Iterator[Tab]:
    page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT})
    page.set_default_timeout(1000 * PATIENCE)
    tab = Tab(page, tmp_path)
    page.on("request", lambda request: tab.requests.append(request.url))
    page.on("websocket", lambda socket: tab.requests.append(socket.url))
    page.on("pageerror", lambda error: tab.complaints.append(str(error)))
    page.on("console", lambda message: note(tab, message))
    yield tab
    page.close()


def note(tab: Tab, message: api.ConsoleMessage) -> None:
    if message.type == "error":
        tab.complaints.append(message.text)


@pytest.fixture(scope="module")
def page_file(
    problem: Problem,
    plan: Plan,
    exhibit: Exhibit,
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    path = tmp_path_factory.mktemp("page") / "plan.html"
    curve = clearance_curve(problem, plan, exhibit.film)
    write_page(path, exhibit, curve, list(searches(problem, plan)))
    return path


def open_page(tab: Tab, path: Path) -> None:
    tab.page.goto(path.as_uri())
    tab.page.wait_for_selector("body[data-ready]", state="attached")


def test_the_page_plays_without_fetching_anything(tab: Tab, page_file: Path) -> None:
    open_page(tab, page_file)
    assert not moves(recording(tab, 1.0))
    tab.page.click("#play")
    assert moves(recording(tab, 60.0))
    assert tab.page.text_content("#play") == "Pause"
    assert tab.requests == [page_file.as_uri()]
    assert tab.complaints == []


def test_a_frozen_page_does_not_pass_for_one_that_plays(
    tab: Tab, page_file: Path
) -> None:
    frozen = page_file.with_name("frozen.html")
    text = page_file.read_text()
    moving = "this.time += ((now - this.before) / 1000) * this.speed"
    assert moving in text
    frozen.write_text(text.replace(moving, "this.time += 0"))
    open_page(tab, frozen)
    tab.page.click("#play")
    assert not moves(recording(tab, 3.0))


def wait_for_time(tab: Tab, seconds: float) -> None:
    """Until the page shows that time; it lets no script wait for it in there."""
    end = time.monotonic() + 60
    while abs(float(tab.page.evaluate("document.body.dataset.time")) - seconds) > 0.01:
        assert time.monotonic() < end, "the page never came to that time"
        time.sleep(0.1)


def test_segments_candidates_and_cycles_change_the_picture(
    tab: Tab, page_file: Path, plan: Plan
) -> None:
    open_page(tab, page_file)
    before = tab.picture()
    buttons = tab.page.query_selector_all(".marks button")
    names = [s.name for task in plan.tasks for s in task.segments]
    assert [button.text_content() for button in buttons] == names
    buttons[names.index("transfer")].click()
    start = sum(s.duration for s in plan.tasks[0].segments[: names.index("transfer")])
    wait_for_time(tab, start)
    there = tab.picture()
    assert moves([before, there])
    tab.page.click("#candidates summary")
    tab.page.select_option("#candidate", index=1)
    shown = tab.picture()
    assert moves([there, shown])
    text = tab.page.text_content("#candidates")
    for word in ("manipulability", "clutter by link at the goal", "upper_arm"):
        assert word in text
    tab.page.select_option("#candidate", index=0)
    tab.page.evaluate(SLIDE, 1)
    assert tab.page.text_content("#populations").startswith("Populations")
    assert "cycle 1" in tab.page.text_content("#populations")
    assert tab.complaints == []


SLIDE = """(value) => {
  const slider = document.getElementById("cycle");
  slider.value = value;
  slider.dispatchEvent(new Event("input"));
}"""


@pytest.fixture(scope="module")
def live(plan_file: Path) -> Iterator[str]:
    """The address of a live viewer of the plan."""
    with subprocess.Popen(
        [sys.executable, "-m", "mmplan", "view", str(plan_file), "--port", "8200"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        yield process.stdout.readline().strip()
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0


def test_the_live_viewer_plays_on_this_machine_alone(tab: Tab, live: str) -> None:
    tab.page.goto(live)
    play = tab.page.get_by_role("button", name="Play", exact=True)
    play.wait_for()
    tab.page.get_by_text("Candidates of the optimizer").wait_for()
    wait_until_still(tab)
    play.click()
    assert moves(recording(tab, PATIENCE))
    host = urlsplit(live).netloc
    assert f"ws://{host}" in {origin(url) for url in tab.requests}
    assert tab.requests_elsewhere(f"http://{host}", f"ws://{host}", "data://") == []
    assert tab.complaints == []
    assert tab.page.get_by_text("Share").count() == 0


def wait_until_still(tab: Tab) -> None:
    """Until the scene has come and the picture stays as it is."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        pictures = [tab.picture(), tab.picture()]
        if view_of(pictures[0]).std() > 5.0 and not moves(pictures):
            return
    raise AssertionError("the scene does not come to rest")
