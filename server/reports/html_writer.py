"""A report as one HTML file: style and figures inside, no script, nothing fetched."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from html import escape
from typing import assert_never

from server.reports.document import (
    Block,
    Bullets,
    Document,
    Facts,
    Paragraph,
    Picture,
    Section,
    Table,
)

__all__ = ["POLICY", "write_html"]

_STYLE = """
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #eef1f4; color: #14202b;
  font: 15px/1.5 "Inter", "Segoe UI", system-ui, "Noto Sans", "DejaVu Sans", sans-serif;
  font-variant-numeric: tabular-nums; }
main { max-width: 900px; margin: 0 auto; padding: 40px 48px 56px; background: #fff; }
h1 { font-size: 28px; line-height: 1.2; margin: 0; overflow-wrap: anywhere; }
.subtitle { margin: 6px 0 22px; color: #465564; font-size: 16px; overflow-wrap: anywhere; }
h2 { font-size: 19px; margin: 38px 0 12px; padding-bottom: 5px; border-bottom: 2px solid #005f99; }
p { margin: 10px 0; max-width: 78ch; overflow-wrap: anywhere; }
.tone { padding: 11px 15px; border-left: 5px solid #7a8794; background: #f3f5f7; max-width: none; }
.good { border-color: #00694b; background: #e7f5f0; }
.bad { border-color: #a94400; background: #fcefe6; }
dl { margin: 10px 0; border-top: 1px solid #dbe2e8; }
dl > div { display: grid; grid-template-columns: 210px 1fr; gap: 16px; padding: 5px 0;
  border-bottom: 1px solid #dbe2e8; }
dt { color: #465564; }
dd { margin: 0; overflow-wrap: anywhere; }
ul { margin: 8px 0; padding-left: 22px; max-width: 80ch; }
figure { margin: 22px 0; break-inside: avoid; }
figure img { width: 100%; height: auto; display: block; }
figcaption { margin-top: 4px; font-weight: 600; }
figcaption span { display: block; font-weight: 400; color: #465564; font-size: 13.5px; }
.wide { overflow-x: auto; margin: 14px 0; }
table { border-collapse: collapse; width: 100%; font-size: 13px; }
caption { text-align: left; font-weight: 600; padding-bottom: 5px; font-size: 14px; }
th, td { padding: 4px 9px; border-top: 1px solid #dbe2e8; text-align: right; vertical-align: top; }
thead th { border-top: 0; border-bottom: 1.5px solid #465564; color: #465564; }
.words { text-align: left; overflow-wrap: break-word; }
tr.marked { background: #e3f0f8; font-weight: 600; }
footer { margin-top: 40px; padding-top: 10px; border-top: 1px solid #dbe2e8; color: #5a6874;
  font-size: 13px; overflow-wrap: anywhere; }
@media (max-width: 620px) {
  main { padding: 22px 16px; }
  dl > div { grid-template-columns: 1fr; gap: 0; }
}
@media print {
  @page { size: A4; margin: 18mm 16mm; }
  body { background: #fff; font-size: 10pt; }
  main { padding: 0; max-width: none; }
  .wide { overflow: visible; }
  tr, .tone { break-inside: avoid; }
  h2 { break-after: avoid; }
}
"""
_DIGEST = base64.b64encode(hashlib.sha256(_STYLE.encode()).digest()).decode()
_INSIDE = (
    f"default-src 'none'; img-src data:; style-src 'sha256-{_DIGEST}'; base-uri 'none'; "
    "form-action 'none'"
)

POLICY = f"{_INSIDE}; frame-ancestors 'self'"
"""The content policy with which the file is served; most of it stands in the file as well."""

_KINDS = {"svg": "image/svg+xml", "png": "image/png"}


def write_html(document: Document, pictures: Mapping[str, tuple[str, bytes]]) -> str:
    """Writes a report.

    Args:
        document: The report.
        pictures: Format (``svg`` or ``png``) and content of each figure, by its name.

    Returns:
        The file; every text in it is escaped.
    """
    sections = "".join(_section(section, pictures) for section in document.sections)
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{escape(_INSIDE)}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(document.title)}</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        f'<main>\n<h1>{escape(document.title)}</h1>\n<p class="subtitle">'
        f"{escape(document.subtitle)}</p>\n{_facts(document.head)}{sections}"
        f"<footer>{escape(document.footer)}</footer>\n</main>\n</body>\n</html>\n"
    )


def _section(section: Section, pictures: Mapping[str, tuple[str, bytes]]) -> str:
    blocks = "".join(_block(block, pictures) for block in section.blocks)
    return f"<section>\n<h2>{escape(section.title)}</h2>\n{blocks}</section>\n"


def _block(block: Block, pictures: Mapping[str, tuple[str, bytes]]) -> str:
    match block:
        case Paragraph():
            return _paragraph(block)
        case Facts():
            return _facts(block)
        case Bullets():
            items = "".join(f"<li>{escape(item)}</li>" for item in block.items)
            return f"<ul>{items}</ul>\n" if items else ""
        case Table():
            return _table(block)
        case Picture():
            return _picture(block, pictures)
        case _:
            assert_never(block)


def _paragraph(block: Paragraph) -> str:
    tone = "" if block.tone == "plain" else f' class="tone {block.tone}"'
    heading = f"<strong>{escape(block.heading)}</strong> " if block.heading else ""
    return f"<p{tone}>{heading}{escape(block.text)}</p>\n"


def _facts(block: Facts) -> str:
    rows = "".join(
        f"<div><dt>{escape(name)}</dt><dd>{escape(text)}</dd></div>" for name, text in block.rows
    )
    return f"<dl>{rows}</dl>\n"


def _table(block: Table) -> str:
    sides = [' class="words"' if i in block.words else "" for i in range(len(block.heads))]
    heads = "".join(
        f'<th scope="col"{side}>{escape(text)}</th>'
        for side, text in zip(sides, block.heads, strict=True)
    )
    rows = "".join(
        _row(row, sides, marked=index in block.marked) for index, row in enumerate(block.rows)
    )
    caption = f"<caption>{escape(block.caption)}</caption>" if block.caption else ""
    name = escape(block.caption or "Table")
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{name}"><table>{caption}'
        f"<thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table></div>\n"
    )


def _row(row: tuple[str, ...], sides: list[str], *, marked: bool) -> str:
    cells = "".join(f"<td{side}>{escape(text)}</td>" for side, text in zip(sides, row, strict=True))
    opened = '<tr class="marked">' if marked else "<tr>"
    return f"{opened}{cells}</tr>"


def _picture(block: Picture, pictures: Mapping[str, tuple[str, bytes]]) -> str:
    file_format, content = pictures[block.name]
    data = base64.b64encode(content).decode()
    return (
        f'<figure><img alt="{escape(block.words)}" '
        f'src="data:{_KINDS[file_format]};base64,{data}"><figcaption>{escape(block.caption)}'
        f"<span>{escape(block.words)}</span></figcaption></figure>\n"
    )
