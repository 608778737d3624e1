"""The direct method for nonlinear train-bridge interaction: ``from solver import simulate``."""

from solver.studies import Study, assess, check, modal_analysis, simulate, template, templates

__all__ = ["Study", "assess", "check", "modal_analysis", "simulate", "template", "templates"]
