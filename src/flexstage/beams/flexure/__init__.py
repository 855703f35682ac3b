"""Flexures at large displacements: tables of bending, twist and stretch modes along their length."""
