"""Diagnosis of an identification: adequacy, delay, unexplained peaks and warnings."""
