"""Stages under load and away from the drawn position: stability, strokes, load cases."""
