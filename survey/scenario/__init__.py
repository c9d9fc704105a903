"""Scenario files: read, checked, and turned into parts in SI units."""

from survey.scenario.faults import ScenarioError
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario

__all__ = ["Scenario", "ScenarioError", "load_scenario"]
