"""The page of a replay: viser's own, with a caption, a colour bar and the script that colours."""

from __future__ import annotations

from functools import cache
from html import escape
from importlib.resources import files

from server.viewer.captions import bar_title
from server.viewer.colour_map import ColourBar
from server.viewer.palette import Theme
from server.viewer.proxy import page_script

__all__ = ["offline_page"]

_INK: dict[Theme, str] = {"light": "#1c2733", "dark": "#e6ebf0"}
_PAPER: dict[Theme, str] = {"light": "255,255,255", "dark": "20,22,25"}
_STYLE = """<style>
[data-floating-window], #webgl-software-rendering {{ display: none !important; }}
#replay-words {{ position: fixed; z-index: 2; top: 0; left: 0; right: 0; padding: 0.5em 0.9em;
  font: 14px/1.4 system-ui, sans-serif; color: {ink}; background: rgba({paper}, 0.8);
  pointer-events: none; }}
#replay-bar {{ width: min(24em, 90%); margin-top: 0.3em; }}
#replay-bar div {{ height: 0.8em; border: 1px solid {ink}; }}
#replay-bar p {{ margin: 0; display: flex; justify-content: space-between; }}
</style>"""


def offline_page(recorded: str, caption: str, bar: ColourBar | None, theme: Theme) -> str:
    """A page that opens from disk.

    Args:
        recorded: What viser's serializer made.
        caption: What it shows and what it leaves out.
        bar: What its colours mean.
        theme: Light or dark.
    """
    style = _STYLE.format(ink=_INK[theme], paper=_PAPER[theme])
    head = style + page_script().decode() + _light_script()
    words = f'<div id="replay-words">{escape(caption)}{_bar(bar)}</div>'
    # Only viser's own page stands before the first of each: its data is one long word.
    page = recorded.replace("</head>", head + "</head>", 1)
    before, body, after = page.rpartition("</body>")
    return f"{before}{words}{body}{after}"


@cache
def _light_script() -> str:
    script = files("server.viewer").joinpath("client", "replay.mjs").read_text(encoding="utf-8")
    return f'<script type="module">{script}</script>'


def _bar(bar: ColourBar | None) -> str:
    if bar is None:
        return ""
    stops = ", ".join(f"{colour} {100.0 * place:.1f}%" for place, colour in bar.stops)
    middle = (bar.minimum + bar.maximum) / 2.0
    values = (f"<span>{_number(value)}</span>" for value in (bar.minimum, middle, bar.maximum))
    return (
        f'<div id="replay-bar">{escape(bar_title(bar))}'
        f'<div style="background: linear-gradient(to right, {stops})"></div>'
        f"<p>{''.join(values)}</p></div>"
    )


def _number(value: float) -> str:
    return f"{value:.3g}".replace("-", "−")
