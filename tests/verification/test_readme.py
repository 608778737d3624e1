"""The README's Python example runs as printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[2] / "README.md"


def test_python_example_prints_the_deflection(capsys: pytest.CaptureFixture[str]) -> None:
    text = README.read_text(encoding="utf-8")
    found = re.search(r"<!-- python example -->\s*```python\n(.+?)\n```", text, re.S)
    assert found
    exec(found.group(1), {})
    assert "mid-span deflection 2.40" in capsys.readouterr().out
