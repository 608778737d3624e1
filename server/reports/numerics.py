"""The section of mesh and time step, with what is known of their error."""

from __future__ import annotations

from typing import Any

import numpy as np

from server.reports.document import Block, Bullets, Facts, Paragraph, Section, Table
from server.reports.material import Material
from server.reports.words import number, percent, with_unit
from solver.integrators.stability import amplification_matrix
from solver.units import Units

__all__ = ["accuracy_section", "step_error"]

_REFERENCE = (5.0, 10.0, 30.0, 60.0)
"""Frequencies at which the step's error is stated, beside the cut-off. [Hz]"""


def step_error(alpha: float, time_step: float, frequency: float) -> tuple[float, float]:
    """Error of the HHT-alpha method on one undamped oscillator.

    Args:
        alpha: Of the method. [1]
        time_step: [s]
        frequency: Of the oscillator. [Hz]

    Returns:
        Relative elongation of the period, and damping ratio that the method adds; both [1].
    """
    beta, gamma = (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha
    exact = 2.0 * np.pi * frequency * time_step
    roots = np.linalg.eigvals(amplification_matrix(alpha, beta, gamma, exact))
    # The physical pair of roots turns nearly as the exact solution; the third one is real.
    root = roots[np.argmax(roots.imag)]
    turned = float(np.angle(root))
    return exact / turned - 1.0, -float(np.log(np.abs(root))) / turned


def accuracy_section(material: Material) -> Section:
    """Unknowns, step, number of steps, and their error as far as it was measured."""
    run = material.deciding
    facts = run.facts
    rows: list[tuple[str, str]] = []
    level = facts.get("mesh_level")
    if level:
        rows.append(("Mesh", str(level)))
    rows += [("Unknowns", _unknowns(facts))]
    blocks: list[Block] = []
    if not material.modal:
        step = material.study.integration.time_step
        rows += [
            ("Time step", with_unit(step, Units.time_step)),
            ("Time steps", number(run.reader.plan.n_sample - 1, 9)),
            ("Method", f"HHT-alpha, alpha = {number(material.study.integration.alpha)}"),
        ]
        if "contact_law" in facts:
            rows.append(("Contact", str(facts["contact_law"])))
    blocks.append(Facts(rows=tuple(rows)))
    blocks += _mesh_error(facts)
    if not material.modal:
        blocks.append(_step_table(material))
    return Section(title="Mesh and time step", blocks=tuple(blocks))


def _unknowns(facts: Any) -> str:
    if "unknowns" in facts:
        return number(facts["unknowns"], 9)
    parts = [(name, facts.get(f"unknowns_{name}")) for name in ("structure", "rails", "train")]
    known = [(name, int(count)) for name, count in parts if count]
    if not known:
        return "–"
    total = number(sum(count for _, count in known), 9)
    return f"{total}: " + ", ".join(f"{name} {number(count, 9)}" for name, count in known)


def _mesh_error(facts: Any) -> list[Block]:
    measured = tuple(str(text) for text in facts.get("mesh_accuracy") or ())
    if measured:
        return [Paragraph(text="Error of the mesh, as measured:"), Bullets(items=measured)]
    text = "The error of this mesh was not measured on this study."
    if facts.get("mesh_level") in ("coarse", "standard"):
        text += " Compute the study on the next finer mesh to know it."
    return [Paragraph(text=text)]


def _step_table(material: Material) -> Table:
    integration = material.study.integration
    cut_off = float(material.deciding.summary.get("cut_off") or 0.0)
    for verdict in material.verdicts[:1]:
        cut_off = float(verdict["cut_off"])
    asked = set(_REFERENCE) | ({cut_off} if cut_off > 0.0 else set())
    frequencies: list[float] = sorted(asked)
    rows: list[tuple[str, ...]] = []
    for frequency in frequencies:
        period, damping = step_error(integration.alpha, integration.time_step, frequency)
        mark = " (cut-off)" if frequency == cut_off else ""
        rows.append((f"{number(frequency)}{mark}", percent(period), percent(damping)))
    return Table(
        heads=("frequency [Hz]", "period too long by", "damping ratio added"),
        rows=tuple(rows),
        caption=(
            "Error of the time step: exact for one undamped oscillator, from the eigenvalues of "
            "the method's amplification matrix"
        ),
        words=(),
        marked=tuple(index for index, item in enumerate(frequencies) if item == cut_off),
    )
