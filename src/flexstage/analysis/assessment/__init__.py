"""Measures, requirements, error budgets and sensitivities."""
