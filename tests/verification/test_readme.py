"""The Python examples of the documentation run as printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_python_example_prints_the_deflection(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"<!-- python example -->\s*```python\n(.+?)\n```", text, re.S)
    assert found
    exec(found.group(1), {})
    assert "mid-span deflection 2.40" in capsys.readouterr().out


def test_examples_of_the_direct_method_run(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / "direct-method.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.+?)\n```", text, re.S)
    assert len(examples) == 2
    for example in examples:
        exec(example, {})
    printed = capsys.readouterr().out
    assert "mid-span deflection 2.41 mm" in printed
    assert "the contact jumps at 3.93 mm" in printed
    assert "k_h = 1211 MN/m" in printed
    assert re.search(r"worn: contact -?\d+\.\d mm", printed)
