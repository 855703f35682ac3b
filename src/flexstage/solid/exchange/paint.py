"""Colours of solids in files, as linear red, green and blue from 0 to 1."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

Colour = tuple[float, float, float]

_COLOURS: tuple[Colour, ...] = (
    (0.45, 0.50, 0.56),
    (0.86, 0.55, 0.16),
    (0.16, 0.42, 0.66),
    (0.33, 0.58, 0.36),
    (0.63, 0.27, 0.32),
    (0.48, 0.38, 0.62),
    (0.20, 0.57, 0.58),
    (0.70, 0.64, 0.30),
    (0.62, 0.44, 0.31),
    (0.74, 0.76, 0.79),
)


def palette(names: Iterable[str]) -> Mapping[str, Colour]:
    """Assign a colour to every distinct name, in order; colours repeat after ten names.

    >>> colours = palette(["steel", "stack", "steel"])
    >>> list(colours), colours["steel"] == colours["stack"]
    (['steel', 'stack'], False)
    """
    return {name: _COLOURS[number % len(_COLOURS)] for number, name in enumerate(dict.fromkeys(names))}
