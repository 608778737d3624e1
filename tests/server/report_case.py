"""What tests of the report share: a text that breaks what does not escape it; a page's words."""

from __future__ import annotations

import re
from html import unescape

NASTY = "<script>alert(1)</script> \"&' </style> \u202e\0 漢字 čeština"


def text_of(page: str) -> str:
    """The words of a page of HTML."""
    return unescape(re.sub(r"<[^>]*>", " ", page))
