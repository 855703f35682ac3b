"""Errors of beam theory: hinges by finite elements, the laws of `beams.elasticity` fitted to them, and how far off these are.

    python -m tools.validation.beam_errors             # the hinges that the numbers in the code are fitted to
    python -m tools.validation.beam_errors --check 12  # twelve others of every family: how far the errors stated are off

Hinges are kept in the user's cache. The sample is Halton's, scrambled by a stated seed.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from flexstage.base.number import Array
from flexstage.beams.compliance import law_of
from flexstage.beams.elasticity import LAWS, HingeDimensions, Numbers
from flexstage.beams.validity import hinge_dimensions, validity, within
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.hinges.hinge_form import HingeForm
from flexstage.solid.fea.hinges.roots import own_roots
from flexstage.solid.fea.jobs.hinge_cache import hinges_from_cache
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.spatial.frame import COMPONENTS

COUNTS = {
    "notch circular": 48,
    "notch elliptic": 72,
    "notch filleted": 64,
    "leaf": 32,
    "rod": 4,
    "notch straight": 10,
    "neck circular": 24,
    "neck straight": 8,
}
SEEDS = {"fit": 7, "check": 99}
ASKED = Accuracy(error=0.0, orders=(3, 5), meshes=1, freedoms=130_000)
_YOUNG = 200e9


def part_of(kind: str, share: Array) -> tuple[Shaped, float]:
    """A hinge 1 mm thick, and its Poisson's ratio, from four numbers between 0 and 1; proportions are logarithmic."""

    def between(index: int, low: float, high: float) -> float:
        return float(low * (high / low) ** share[index])

    one = 1e-3
    poisson = 0.2 + 0.2 * float(share[0])
    if kind == "notch circular":
        radius = one / between(1, 0.02, 0.8)
        return Notch("m", one, between(2, 1.0, min(20.0, 12.0 * radius / one)) * one, Circular(radius)), poisson
    if kind == "notch elliptic":
        throat, flat = one / between(1, 0.02, 0.8), between(3, 0.2, 1.6)
        along = max(throat * flat, one / flat)  # at least as high as the neck is thick
        return Notch("m", one, between(2, 1.0, min(20.0, 12.0 * along / one)) * one, Elliptic(along, along * flat)), poisson
    if kind == "notch filleted":
        radius = one / between(1, 0.1, 1.0)
        return Notch("m", one, between(2, 1.0, 20.0) * one, Filleted(2.0 * radius + one * between(3, 1.0, 20.0), radius)), poisson
    if kind == "notch straight":
        return Notch("m", one, between(2, 1.0, 20.0) * one, Straight(between(1, 3.0, 30.0) * one)), poisson
    if kind == "neck circular":
        return Neck("m", one, Circular(one / between(1, 0.02, 0.5))), poisson
    if kind == "neck straight":
        return Neck("m", one, Straight(between(1, 3.0, 30.0) * one), width=between(2, 0.5, 2.0) * one), poisson
    if kind == "rod":
        return Rod("m", between(1, 5.0, 60.0) * one, one), poisson
    width = between(1, 0.05, 3.0)
    return Leaf("m", 20 * one, 20 * one * min(1.0, width) * between(2, 0.005, 0.05), 20 * one * width), poisson


def sampled(kind: str, count: int, seed: int) -> list[tuple[Shaped, float]]:
    """Hinges of a kind."""
    return [part_of(kind, share) for share in qmc.Halton(4, scramble=True, rng=np.random.default_rng(seed)).random(count)]


def computed(parts: list[tuple[Shaped, float]]) -> list[Array]:
    """Their direct compliances (6,) by finite elements times Young's modulus, from the cache where they are there."""
    forms = {
        str(number): HingeForm(part, Material(young=_YOUNG, poisson=poisson, density=7750.0), own_roots(part))
        for number, (part, poisson) in enumerate(parts)
    }
    return [_YOUNG * np.diag(found.compliance) for found in hinges_from_cache(forms, ASKED, Ways()).values()]


def stacked(slots: list[HingeDimensions]) -> HingeDimensions:
    """Many hinges as one batch."""
    names = ("thickness", "width", "half", "along", "across", "poisson", "beam")
    return HingeDimensions(*(np.stack([getattr(slot, name) for slot in slots]) for name in names))


def fitted(family: str, axis: str, slot: HingeDimensions, found: Array) -> Numbers:
    """The numbers of a law from elements, robustly (soft L1, 1 %), from those in the code."""
    law, start = LAWS[family][axis]
    inside = within(family, axis, slot)
    true = found[:, COMPONENTS.index(axis)]

    def off(numbers: Array) -> Array:
        return np.nan_to_num(100.0 * (law(slot, tuple(numbers)) / true - 1.0), nan=1e3)[inside]

    scale = np.maximum(np.abs(start), 0.1)
    return tuple(float(f"{value:.4g}") for value in least_squares(off, start, loss="soft_l1", f_scale=1.0, x_scale=scale).x)


def _family(part: Shaped) -> str | None:
    """The family of fitted laws of a part."""
    own = law_of(part)
    return own.family(part) if own else None


def fits() -> Iterator[str]:
    """By family and axis the numbers fitted, and how far off they leave the compliance."""
    parts = [each for kind, count in COUNTS.items() for each in sampled(kind, count, SEEDS["fit"])]
    elements = computed(parts)
    for family, axes in LAWS.items():
        own = [
            (hinge_dimensions(part, poisson), found)
            for (part, poisson), found in zip(parts, elements, strict=True)
            if _family(part) == family
        ]
        slot, found = stacked([each for each, _ in own]), np.stack([each for _, each in own])
        for axis, (law, _) in axes.items():
            numbers = fitted(family, axis, slot, found)
            inside = within(family, axis, slot)
            off = 100.0 * (law(slot, numbers) / found[:, COMPONENTS.index(axis)] - 1.0)[inside]
            rms = np.sqrt(np.mean(off**2))
            yield f"{family:7} {axis:2} {numbers}: rms {rms:.2f} %, largest {np.max(np.abs(off)):.2f} % of {len(off)}"


def checks(count: int) -> Iterator[str]:
    """Of hinges that nothing was fitted to: the error stated beside the one found, in percent."""
    parts = [each for kind in COUNTS for each in sampled(kind, count, SEEDS["check"])]
    worst: dict[tuple[str, str], list[float]] = {}
    for (part, poisson), found in zip(parts, computed(parts), strict=True):
        beam = hinge_dimensions(part, poisson).beam
        stated = validity(part, material=Material(young=_YOUNG, poisson=poisson, density=1.0)).errors
        for axis, error in stated.items():
            true = beam[COMPONENTS.index(axis)] / found[COMPONENTS.index(axis)] - 1.0
            worst.setdefault((_family(part) or "", axis), []).append(100.0 * float(error - true))
    for (family, axis), off in worst.items():
        rms, largest = np.sqrt(np.mean(np.square(off))), max(map(abs, off))
        yield f"{family:7} {axis:2} stated less found: rms {rms:.2f}, largest {largest:.2f} points of {len(off)}"


def main() -> None:
    """Print the fits, or with `--check` how far off the errors stated are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", type=int, default=0, metavar="COUNT")
    asked = parser.parse_args()
    for line in checks(asked.check) if asked.check else fits():
        print(line)


if __name__ == "__main__":
    main()
