"""What the first page costs: bytes, requests; and nothing ever comes from elsewhere.

How soon it can be used is measured by ``tests/benchmarks/page.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from tests.browser.waiting import still

sync_api = pytest.importorskip("playwright.sync_api", reason="pip install playwright")
expect = sync_api.expect

LARGEST_FIRST_PAGE = 200_000
"""Transferred before the chart library. [B]"""
MOST_REQUESTS = 80
"""Files of the first page and what it asks the server: each costs a round trip of 6 at once."""
RUN = "button.primary"


@dataclass
class Transfer:
    """What came over the wire, headers too."""

    sizes: dict[str, float] = field(default_factory=dict)
    """Of each request's address, with its number. [B]"""

    @property
    def total(self) -> float:
        """[B]"""
        return sum(self.sizes.values())

    def largest(self) -> list[tuple[str, float]]:
        """The ten largest, for whoever has to find what grew."""
        return sorted(self.sizes.items(), key=lambda item: -item[1])[:10]


@contextmanager
def watched(page: Any) -> Iterator[Transfer]:
    """Counts what a page receives, compressed as it came, event streams while they last."""
    transfer = Transfer()
    addresses: dict[str, str] = {}
    session = page.context.new_cdp_session(page)

    def asked(event: dict[str, Any]) -> None:
        name = f"{len(addresses)} {event['request']['url']}"
        addresses[event["requestId"]] = name
        transfer.sizes[name] = 0.0

    # Of requests from before, as the event stream of the page that is left, nothing is counted.
    def received(event: dict[str, Any]) -> None:
        if name := addresses.get(event["requestId"]):
            transfer.sizes[name] += max(0, event["encodedDataLength"])

    def ended(event: dict[str, Any]) -> None:
        if name := addresses.get(event["requestId"]):
            transfer.sizes[name] = event["encodedDataLength"]

    session.on("Network.requestWillBeSent", asked)
    session.on("Network.dataReceived", received)
    session.on("Network.loadingFinished", ended)
    session.send("Network.enable")
    yield transfer
    session.detach()


def _open_home(page: Any) -> None:
    page.goto("/")
    page.locator(f"tb-template-card {RUN}").first.wait_for()
    expect(page.locator(".skeleton")).to_have_count(0)
    still(page)  # What cards ask for once they are drawn counts too.


def test_the_first_page_is_small_and_needs_no_chart_library(page: Any) -> None:
    with watched(page) as transfer:
        _open_home(page)
    print(f"first page: {transfer.total / 1e3:.1f} kB, {len(transfer.sizes)} requests")
    assert transfer.total < LARGEST_FIRST_PAGE, transfer.largest()
    assert len(transfer.sizes) <= MOST_REQUESTS, sorted(transfer.sizes)
    assert not [name for name in transfer.sizes if "plotly" in name]


def test_the_second_visit_transfers_hardly_a_file_again(new_page: Callable[..., Any]) -> None:
    page = new_page(viewer=True)  # Where requests are intercepted, Chromium keeps no files.
    _open_home(page)
    with watched(page) as transfer:
        page.reload()
        page.locator(f"tb-template-card {RUN}").first.wait_for()
    files = {name: size for name, size in transfer.sizes.items() if "/static/" in name}
    # An answer of 304 has some 300 B of headers.
    assert max(files.values()) < 800, transfer.largest()


@pytest.mark.parametrize(
    "address", ["/", "/#/jobs", "/#/study/khst-alverca", "/#/compare", "/#/library"]
)
def test_no_page_asks_anybody_else(page: Any, server: str, address: str) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    page.locator("main h1").first.wait_for()
    still(page)
    own = (f"{server}/", "data:", "blob:")
    assert [url for url in asked if not url.startswith(own)] == []
    assert len(asked) > 5
    policy = page.request.get("/").headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "http" not in policy
    assert "unsafe" not in policy
