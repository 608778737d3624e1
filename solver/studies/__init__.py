"""Studies: what a user asks for, how it is checked, how it becomes runs and verdicts."""

from solver.studies.assess import Assessment, assess
from solver.studies.bounds import Finding
from solver.studies.check import Quantity, Report, check
from solver.studies.estimate import Estimate
from solver.studies.json import to_json
from solver.studies.modes import modal_analysis
from solver.studies.prepare import prepare, prepare_model, runs_of
from solver.studies.shared import model_key, source_digest
from solver.studies.simulate import simulate
from solver.studies.study import Study
from solver.studies.templates import Template, template, templates

__all__ = [
    "Assessment",
    "Estimate",
    "Finding",
    "Quantity",
    "Report",
    "Study",
    "Template",
    "assess",
    "check",
    "modal_analysis",
    "model_key",
    "prepare",
    "prepare_model",
    "runs_of",
    "simulate",
    "source_digest",
    "template",
    "templates",
    "to_json",
]
