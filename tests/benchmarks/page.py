"""What the first page costs: bytes, requests, time until a study can be run; beside the promises.

Run with ``python -m tests.benchmarks.page`` (some seconds; needs Chromium and Playwright) and read
the table. Nothing else should compute meanwhile: the load of the machine is printed with it.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from tests.benchmarks.queue_served import served
from tests.benchmarks.table import Row, print_table
from tests.browser.waiting import LAUNCH_MS, patient, until

LARGEST_FIRST_PAGE = 200.0
"""Transferred before the chart library. [kB]"""
LONGEST_START = 1.0
"""Until the first Run can be pressed, on loopback. [s]"""
REPEATS = 5
TELL_WHEN_READY = """
new MutationObserver((_, observer) => {
  const run = document.querySelector("tb-template-card button.primary");
  if (!run || run.disabled) return;
  window.readyAt = performance.now();
  observer.disconnect();
}).observe(document, { childList: true, subtree: true, attributes: true });
"""


@dataclass(frozen=True, kw_only=True)
class Visit:
    """A first visit.

    Attributes:
        bytes: What came over the wire, compressed as it came, headers too. [B]
        requests: Files and answers of the server.
        ready: From the beginning of the visit until the first Run can be pressed. [s]
    """

    bytes: float
    requests: int
    ready: float


def visited(browser: Any, address: str) -> Visit:
    """Opens the first page with nothing in the browser's cache."""
    context = patient(browser.new_context(viewport={"width": 1280, "height": 860}))
    page = context.new_page()
    sizes: dict[str, float] = {}
    session = context.new_cdp_session(page)
    session.on("Network.requestWillBeSent", lambda event: sizes.setdefault(event["requestId"], 0.0))
    session.on(
        "Network.loadingFinished",
        lambda event: sizes.update({event["requestId"]: event["encodedDataLength"]}),
    )
    session.send("Network.enable")
    page.add_init_script(TELL_WHEN_READY)
    page.goto(address)
    page.locator("tb-template-card button.primary").first.wait_for()
    page.locator("tb-machine dl").wait_for()  # what the page asks for last
    page.wait_for_timeout(200)
    until(lambda: page.evaluate("window.readyAt ?? null"), "Run can be pressed", page=page)
    visit = Visit(
        bytes=sum(sizes.values()),
        requests=len(sizes),
        ready=page.evaluate("window.readyAt") / 1e3,
    )
    context.close()
    return visit


def rows(*, quick: bool) -> Iterator[Row]:
    """Every measurement; nothing where there is no Chromium."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        return
    from playwright.sync_api import sync_playwright

    with served() as server, sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--no-sandbox"], timeout=LAUNCH_MS
        )
        address = str(server.http.base_url.join("/"))
        visits = [visited(browser, address) for _ in range(2 if quick else REPEATS)]
        browser.close()
    first = visits[0]
    size = first.bytes / 1e3
    yield Row(name="first page", unit="kB", value=size, bound=LARGEST_FIRST_PAGE)
    yield Row(name="requests of the first page", unit="", value=first.requests)
    # The best: others may use the processor meanwhile.
    ready = min(visit.ready for visit in visits)
    yield Row(name="first Run can be pressed", unit="s", value=ready, bound=LONGEST_START)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints the table."""
    print_table(__doc__, rows, arguments, quick="fewer visits")


if __name__ == "__main__":
    main()
