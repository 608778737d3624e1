"""What a spreadsheet puts on the clipboard, pasted at a cell."""

from __future__ import annotations

__all__ = ["PASTE"]

PASTE = """(element, text) => {
  const data = new DataTransfer();
  data.setData("text/plain", text);
  const options = { clipboardData: data, bubbles: true, cancelable: true };
  element.dispatchEvent(new ClipboardEvent("paste", options));
}"""
"""Function of the page: a paste of plain text at an element."""
