"""Studies: what a user asks for, how it is checked, how it becomes runs and verdicts."""

from solver.studies.assess import Assessment, assess
from solver.studies.bounds import Finding
from solver.studies.check import Quantity, Report, check
from solver.studies.estimate import Estimate
from solver.studies.json import to_json
from solver.studies.modes import ModalRun, modal_analysis, modal_run
from solver.studies.prepare import prepare, prepare_model, runs_of
from solver.studies.profile_rules import sample_order
from solver.studies.resonance import SpanFrequency, known_frequency, resonance_speeds
from solver.studies.shared import model_key, source_digest
from solver.studies.simulate import simulate
from solver.studies.study import JobKind, Study
from solver.studies.templates import Template, template, templates

__all__ = [
    "Assessment",
    "Estimate",
    "Finding",
    "JobKind",
    "ModalRun",
    "Quantity",
    "Report",
    "SpanFrequency",
    "Study",
    "Template",
    "assess",
    "check",
    "known_frequency",
    "modal_analysis",
    "modal_run",
    "model_key",
    "prepare",
    "prepare_model",
    "resonance_speeds",
    "runs_of",
    "sample_order",
    "simulate",
    "source_digest",
    "template",
    "templates",
    "to_json",
]
