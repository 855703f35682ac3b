"""Shipped stages: functions that build a description from parameters, and the catalogue of the stages."""
