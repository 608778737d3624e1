"""A report as PDF, A4: fpdf2 with the DejaVu fonts that come with matplotlib.

fpdf2 and the fonts are imported on first use. Embedding fonts takes most of a second, so the server
writes PDF in its drawing process.
"""

from __future__ import annotations

import logging
import unicodedata
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any, assert_never

from server.reports.document import Block, Bullets, Document, Facts, Paragraph, Picture, Table

__all__ = ["write_pdf"]

_FAMILY = "DejaVu"
_FONTS = {"": "DejaVuSans.ttf", "B": "DejaVuSans-Bold.ttf"}
_INK, _SOFT, _LINE, _ACCENT = (20, 32, 43), (70, 85, 100), (205, 213, 220), (0, 95, 153)
_TONES = {
    "good": ((231, 245, 240), (0, 105, 75)),
    "bad": ((252, 239, 230), (169, 68, 0)),
    "note": ((243, 245, 247), (122, 135, 148)),
}
_MARKED = (227, 240, 248)
_MARGIN, _BOTTOM = 18.0, 20.0
_LINE_HEIGHT = 5.0
_TABLE_LINE = 4.3
_SHORT_TABLE = 12
"""Rows of a table that is not torn."""
_FACT_WIDTH = 54.0
_HEADING = 16.0
_PICTURE_SHAPE = 4.2 / 9.0
"""Height over width where the picture does not say."""


def write_pdf(document: Document, pictures: Mapping[str, bytes]) -> bytes:
    """Writes a report.

    Args:
        document: The report.
        pictures: PNG of each figure, by its name.

    Returns:
        The file.
    """
    logging.getLogger("fpdf").setLevel(logging.ERROR)
    logging.getLogger("fontTools").setLevel(logging.ERROR)
    sheet = _new_sheet(document)
    _write_head(sheet, document)
    for section in document.sections:
        _write_heading(sheet, section.title, _head_height(sheet, section.blocks, pictures))
        for block in section.blocks:
            _write_block(sheet, block, pictures)
    return bytes(sheet.output())


def _new_sheet(document: Document) -> Any:
    """An empty file with fonts, margins and a footer on every page."""
    import matplotlib as mpl
    from fpdf import FPDF

    footer = _clean(document.footer)

    class Sheet(FPDF):
        def footer(self) -> None:
            self.set_y(-14.0)
            self.set_font(_FAMILY, size=7.5)
            self.set_text_color(*_SOFT)
            width = self.epw / 2
            self.cell(width, 5.0, footer)
            self.cell(width, 5.0, f"Page {self.page_no()} of {{nb}}", align="R")

    sheet = Sheet(orientation="portrait", unit="mm", format="A4")
    fonts = Path(mpl.get_data_path()) / "fonts" / "ttf"
    for style, name in _FONTS.items():
        sheet.add_font(_FAMILY, style, fonts / name)
    sheet.set_margin(_MARGIN)
    sheet.set_auto_page_break(True, margin=_BOTTOM)
    sheet.set_title(_clean(document.title))
    sheet.set_creator("Trainbridge")
    sheet.set_lang("en")
    sheet.add_page()
    return sheet


def _write_head(sheet: Any, document: Document) -> None:
    sheet.set_text_color(*_INK)
    sheet.set_font(_FAMILY, "B", 19)
    _paragraph(sheet, document.title, 8.5)
    sheet.set_font(_FAMILY, size=10.5)
    sheet.set_text_color(*_SOFT)
    _paragraph(sheet, document.subtitle, 5.5)
    sheet.ln(3.0)
    _write_facts(sheet, document.head)


def _head_height(sheet: Any, blocks: Sequence[Block], pictures: Mapping[str, bytes]) -> float:
    """What must find room on the page of a heading: its first words, and a picture below them."""
    for number, block in enumerate(blocks[:2]):
        if isinstance(block, Picture):
            words = number * (_LINE_HEIGHT + 2.0)
            return _HEADING + words + _picture_height(sheet, block, pictures[block.name])
    return _HEADING + 26.0


def _write_heading(sheet: Any, title: str, needed: float) -> None:
    _keep(sheet, min(needed, sheet.eph))
    sheet.ln(5.0)
    sheet.set_font(_FAMILY, "B", 12.5)
    sheet.set_text_color(*_INK)
    sheet.start_section(_clean(title))
    _paragraph(sheet, title, 6.5)
    sheet.set_draw_color(*_ACCENT)
    sheet.set_line_width(0.5)
    sheet.line(sheet.l_margin, sheet.y + 0.6, sheet.l_margin + sheet.epw, sheet.y + 0.6)
    sheet.ln(3.2)


def _write_block(sheet: Any, block: Block, pictures: Mapping[str, bytes]) -> None:
    sheet.set_font(_FAMILY, size=9)
    sheet.set_text_color(*_INK)
    match block:
        case Paragraph():
            _write_paragraph(sheet, block)
        case Facts():
            _write_facts(sheet, block)
        case Bullets():
            _write_bullets(sheet, block.items)
        case Table():
            _write_table(sheet, block)
        case Picture():
            _write_picture(sheet, block, pictures[block.name])
        case _:
            assert_never(block)
    sheet.ln(2.0)


def _write_paragraph(sheet: Any, block: Paragraph) -> None:
    """Words, in a box with an edge where they carry a tone."""
    text = f"{block.heading} {block.text}".strip()
    if block.tone == "plain" and not block.heading:
        _paragraph(sheet, text, _LINE_HEIGHT)
        return
    if block.tone == "plain":
        _keep(sheet, 2 * _LINE_HEIGHT)
        _words_with_heading(sheet, block, sheet.epw)
        sheet.ln(_LINE_HEIGHT)
        return
    ground, edge = _TONES[block.tone]
    inset, width = 3.5, sheet.epw
    lines = sheet.multi_cell(
        width - 2 * inset, _LINE_HEIGHT, _clean(text), dry_run=True, output="LINES"
    )
    height = len(lines) * _LINE_HEIGHT + 2 * inset + (1.0 if block.heading else 0.0)
    _keep(sheet, height)
    top = sheet.y
    sheet.set_fill_color(*ground)
    sheet.rect(sheet.l_margin, top, width, height, style="F")
    sheet.set_fill_color(*edge)
    sheet.rect(sheet.l_margin, top, 1.2, height, style="F")
    sheet.set_xy(sheet.l_margin + inset, top + inset)
    _words_with_heading(sheet, block, width - 2 * inset)
    sheet.set_xy(sheet.l_margin, top + height)


def _words_with_heading(sheet: Any, block: Paragraph, width: float) -> None:
    left = sheet.x
    sheet.set_left_margin(left)
    sheet.set_right_margin(sheet.w - left - width)
    if block.heading:
        sheet.set_font(_FAMILY, "B", 9)
        sheet.write(_LINE_HEIGHT, _clean(f"{block.heading} "))
        sheet.set_font(_FAMILY, size=9)
    sheet.write(_LINE_HEIGHT, _clean(block.text))
    sheet.set_margins(_MARGIN, _MARGIN, _MARGIN)


def _write_facts(sheet: Any, block: Facts) -> None:
    sheet.set_draw_color(*_LINE)
    sheet.set_line_width(0.15)
    for name, text in block.rows:
        width = sheet.epw - _FACT_WIDTH
        sheet.set_font(_FAMILY, size=8.5)
        lines = sheet.multi_cell(width, _TABLE_LINE, _clean(text), dry_run=True, output="LINES")
        height = max(1, len(lines)) * _TABLE_LINE + 1.6
        _keep(sheet, height)
        top = sheet.y
        sheet.line(sheet.l_margin, top, sheet.l_margin + sheet.epw, top)
        sheet.set_xy(sheet.l_margin, top + 0.8)
        sheet.set_text_color(*_SOFT)
        sheet.cell(_FACT_WIDTH, _TABLE_LINE, _clean(name))
        sheet.set_text_color(*_INK)
        sheet.multi_cell(width, _TABLE_LINE, _clean(text), align="L")
        sheet.set_xy(sheet.l_margin, top + height)
    sheet.line(sheet.l_margin, sheet.y, sheet.l_margin + sheet.epw, sheet.y)
    sheet.ln(1.0)


def _write_bullets(sheet: Any, items: Sequence[str]) -> None:
    for item in items:
        _keep(sheet, _LINE_HEIGHT)
        sheet.set_x(sheet.l_margin + 1.0)
        sheet.cell(4.0, _LINE_HEIGHT, "•")
        sheet.multi_cell(
            sheet.epw - 5.0,
            _LINE_HEIGHT,
            _clean(item),
            align="L",
            new_x="LMARGIN",
            new_y="NEXT",
        )


def _write_table(sheet: Any, block: Table) -> None:
    from fpdf.fonts import FontFace

    # A short table on one page; of a long one at least its head and some rows.
    short = len(block.rows) <= _SHORT_TABLE
    _keep(sheet, 14.0 + (_TABLE_LINE + 1.2) * len(block.rows) if short else 30.0)
    if block.caption:
        sheet.set_font(_FAMILY, "B", 8.5)
        _paragraph(sheet, block.caption, _LINE_HEIGHT)
        sheet.ln(0.8)
    sheet.set_font(_FAMILY, size=7.6)
    sheet.set_fill_color(255, 255, 255)
    sheet.set_draw_color(*_LINE)
    sheet.set_line_width(0.15)
    aligned = tuple("LEFT" if i in block.words else "RIGHT" for i in range(len(block.heads)))
    marked = FontFace(emphasis="B", fill_color=_MARKED)
    with sheet.table(
        col_widths=block.widths or None,
        text_align=aligned,
        line_height=_TABLE_LINE,
        borders_layout="HORIZONTAL_LINES",
        headings_style=FontFace(emphasis="B", color=_SOFT),
        padding=(0.5, 1.2),
        v_align="T",
    ) as table:
        for index, cells in enumerate((block.heads, *block.rows)):
            row = table.row(style=marked if index - 1 in block.marked else None)
            for cell in cells:
                row.cell(_clean(cell))
    sheet.ln(1.5)


def _picture_height(sheet: Any, block: Picture, content: bytes) -> float:
    """A figure with its words, if a page can hold them."""
    sheet.set_font(_FAMILY, size=8.2)
    words = sheet.multi_cell(
        sheet.epw, _TABLE_LINE, _clean(block.words), dry_run=True, output="LINES"
    )
    height = sheet.epw * _shape(content) + (len(words) + 2) * _TABLE_LINE + 4.0
    return min(height, sheet.eph - 1.0)


def _write_picture(sheet: Any, block: Picture, content: bytes) -> None:
    _keep(sheet, _picture_height(sheet, block, content))
    sheet.image(
        BytesIO(content),
        x=sheet.l_margin,
        w=sheet.epw,
        h=sheet.epw * _shape(content),
        alt_text=_clean(block.words)[:500],
    )
    sheet.ln(0.8)
    sheet.set_font(_FAMILY, "B", 8.5)
    _paragraph(sheet, block.caption, _TABLE_LINE)
    sheet.set_font(_FAMILY, size=8.2)
    sheet.set_text_color(*_SOFT)
    _paragraph(sheet, block.words, _TABLE_LINE)
    sheet.ln(2.5)


def _shape(content: bytes) -> float:
    """Height over width of a PNG, from its header."""
    width, height = (int.from_bytes(content[at : at + 4]) for at in (16, 20))
    return height / width if width and height else _PICTURE_SHAPE


def _paragraph(sheet: Any, text: str, line: float) -> None:
    sheet.multi_cell(sheet.epw, line, _clean(text), align="L", new_x="LMARGIN", new_y="NEXT")


def _keep(sheet: Any, height: float) -> None:
    """Begins a page where what follows would be torn."""
    if sheet.y + height > sheet.page_break_trigger:
        sheet.add_page()


def _clean(text: str) -> str:
    """Text without what steers instead of being read."""
    return "".join(
        " " if character in "\n\r\t" else character
        for character in text
        if character in "\n\r\t" or unicodedata.category(character) not in ("Cc", "Cf", "Cs")
    )
