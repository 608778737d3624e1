"""What a report holds, before anybody writes it: sections of words, facts, tables, figures.

Two writers read it: :mod:`server.reports.html_writer` and :mod:`server.reports.pdf_writer`. Text is
plain text; whoever writes it into a format escapes it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

__all__ = ["Block", "Bullets", "Document", "Facts", "Paragraph", "Picture", "Section", "Table"]

Tone: TypeAlias = Literal["plain", "good", "bad", "note"]


@dataclass(frozen=True, kw_only=True)
class Paragraph:
    """A paragraph.

    Attributes:
        text: What it says.
        heading: Words that stand before it, bold.
        tone: What it means for the reader; never said by colour alone.
    """

    text: str
    heading: str = ""
    tone: Tone = "plain"


@dataclass(frozen=True, kw_only=True)
class Facts:
    """Names and what belongs to them."""

    rows: tuple[tuple[str, str], ...]


@dataclass(frozen=True, kw_only=True)
class Bullets:
    """Sentences one below the other."""

    items: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows under heads.

    Attributes:
        heads: One a column, the unit in brackets.
        rows: Texts, as many as heads.
        caption: What it shows.
        words: Columns that hold words, not numbers: set to the left.
        marked: Rows that a reader should see first.
        widths: Relative widths of the columns; even where empty.
    """

    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    caption: str = ""
    words: tuple[int, ...] = (0,)
    marked: tuple[int, ...] = ()
    widths: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Picture:
    """A figure, drawn elsewhere.

    Attributes:
        name: Its name in the API, unique in the report.
        caption: What it shows.
        words: What there is to see, for who cannot see it.
    """

    name: str
    caption: str
    words: str


Block: TypeAlias = Paragraph | Facts | Bullets | Table | Picture


@dataclass(frozen=True, kw_only=True)
class Section:
    """A heading and what stands below it."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True, kw_only=True)
class Document:
    """A report.

    Attributes:
        title: Of the project.
        subtitle: What was computed.
        head: Project, author, date and the job's identity.
        sections: In order.
        footer: On every page: enough to know a loose sheet by.
    """

    title: str
    subtitle: str
    head: Facts
    sections: tuple[Section, ...] = field(default=())
    footer: str = ""
