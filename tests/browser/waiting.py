"""Patience: the machine of the tests may compute at the same time, and draw without a GPU.

Whatever is waited for has a generous deadline, and whoever waits in vain says for what.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

__all__ = [
    "DONE_MS",
    "LAUNCH_MS",
    "PAGE_MS",
    "PATIENCE",
    "drawn_again",
    "patient",
    "patient_expectations",
    "pixels_at_rest",
    "still",
    "until",
]

PATIENCE = 120.0
"""Longest wait for what a server or a page does at once on a machine of its own. [s]"""
PAGE_MS = 60_000
"""The same for what Playwright itself waits for. [ms]"""
LAUNCH_MS = 180_000
"""Longest wait for a browser that starts; Playwright's own is 30 s. [ms]"""
DONE_MS = 240_000
"""Longest wait for a job of seconds, behind those that the server has already. [ms]"""
_POLL = 0.1
"""Between two looks. [s]"""

_FRAMES = """() => new Promise((resolve) => {
  let left = 4;
  const next = () => (left-- > 0 ? requestAnimationFrame(next) : resolve());
  next();
})"""
_CONTENT = """() => {
  let hash = 0;
  for (const letter of document.body.innerHTML) hash = (hash * 31 + letter.codePointAt(0)) | 0;
  const words = [...document.querySelectorAll("tb-chart .summary")];
  const seen = words.filter((item) => item.checkVisibility());
  const awaited = seen.filter((item) => item.textContent === "On its way…");
  const moving = document.getAnimations().filter((item) => item.playState === "running");
  return [hash, moving.length, awaited.length];
}"""

_Seen = TypeVar("_Seen")


def patient(context: Any) -> Any:
    """Has everything on a page, or on all of a browser context, wait long enough."""
    context.set_default_timeout(PAGE_MS)
    context.set_default_navigation_timeout(PAGE_MS)
    return context


def patient_expectations() -> None:
    """The same for ``expect``, whose own patience is 5 s."""
    from playwright.sync_api import expect

    expect.set_options(timeout=PAGE_MS)


def until(
    look: Callable[[], _Seen],
    what: str,
    *,
    page: Any = None,
    met: Callable[[_Seen], Any] = bool,
    seconds: float = PATIENCE,
) -> _Seen:
    """Looks until what is seen is as it should be, and gives it.

    Args:
        look: Gives what is seen now.
        what: Is waited for, in words.
        page: A page whose routes and events are served meanwhile; needed where there are some.
        met: Whether it is so; what is seen is true, if not told.
        seconds: Longest wait. [s]
    """
    limit = time.monotonic() + seconds
    while True:
        seen = look()
        if met(seen):
            return seen
        assert time.monotonic() < limit, f"{what}: not within {seconds:.0f} s; last seen: {seen!r}"
        if page is None:
            time.sleep(_POLL)
        else:
            page.wait_for_timeout(1e3 * _POLL)


def drawn_again(page: Any) -> None:
    """Lets a page draw some pictures, however long its machine takes for them."""
    page.evaluate(_FRAMES)


def still(page: Any) -> None:
    """Waits until a page's content has stayed the same three times, and its charts are there."""
    seen: list[Any] = []

    def look() -> list[Any]:
        page.wait_for_load_state("networkidle")
        drawn_again(page)
        seen.append(page.evaluate(_CONTENT))
        return seen[-3:]

    def at_rest(last: list[Any]) -> bool:
        return len(last) == 3 and all(item == last[0] for item in last) and last[0][2] == 0

    until(look, "the page's content stands still", page=page, met=at_rest)


def pixels_at_rest(
    take: Callable[[], np.ndarray],
    page: Any,
    met: Callable[[np.ndarray], Any] = lambda _: True,
    what: str = "a picture that stands still",
    apart: float = _POLL,
) -> np.ndarray:
    """A picture once three in a row are equal, with several drawn between them, and it is right.

    Args:
        take: Takes a picture.
        page: The page that it is of.
        met: Whether it is the picture that is waited for.
        what: It shows, in words.
        apart: Time between two of them, at least. [s]
    """
    taken: list[np.ndarray] = []
    limit = time.monotonic() + PATIENCE
    while True:
        taken = [*taken[-2:], take()]
        rest = len(taken) == 3 and all(np.array_equal(taken[0], other) for other in taken[1:])
        if rest and met(taken[-1]):
            return taken[-1]
        state = "it stands still" if rest else "it still moves"
        assert time.monotonic() < limit, f"{what}: not within {PATIENCE:.0f} s; {state}"
        page.wait_for_timeout(1e3 * apart)
        drawn_again(page)
