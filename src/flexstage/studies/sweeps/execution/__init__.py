"""Execution of a study: evaluation, storage and combination of designs."""
