"""Stages under load and away from the nominal position: stability, strokes, load cases."""
