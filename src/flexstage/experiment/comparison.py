"""Comparison of model, finite elements and test (Fig. 12 of Shin & Moon), with modes paired by their shapes at the sensors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.analysis.complete import loaded_model, platform_modes, read
from flexstage.analysis.dynamics.modes import Modes, clusters
from flexstage.analysis.dynamics.pairing import RELIABLE, Moving, Pair, gyration, pair_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, first_design
from flexstage.base.record import INNER, VIEW, Graded, Heading, Layout
from flexstage.base.units.quantity import ANGLE, FREQUENCY, RATIO
from flexstage.experiment.channels import Residues, SuspectedFault, gain_doubts, normalise, output_scales, shape_doubt, unit_length
from flexstage.experiment.identification.identified import (
    INFLATION,
    DampingInterval,
    DampingRatio,
    FrequencyInterval,
    Identified,
    Widening,
)
from flexstage.experiment.records.record import names_of
from flexstage.experiment.shapes_on_stage import si_factor, si_shapes
from flexstage.experiment.updating.gains import is_voltage, si_size
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.theory import Model

_REPEATED = 0.01
_FAR, _FARTHEST = 0.3, np.log(1.6)
_SILENT = 1e-6
_PAIRED = 0.5
_TRUSTED = 0.9
_ROUNDS = 20
_ASSURANCE = Heading("MAC", digits=4, mark=Graded(_TRUSTED, 0.0))
_DIFFERENCE = Heading("theory difference", digits=4, unit="%", mark=Graded(0.02, 0.1))
_TURNED = np.deg2rad(20.0)


@dataclass(frozen=True)
class Measured:
    """Identified mode in a comparison: its index (from 0), frequency [Hz] and damping ratio with their 95 % intervals.

    `widening` is the width of the intervals divided by their width due to noise alone.
    """

    index: Annotated[int, INNER]
    frequency: Annotated[float, FREQUENCY, Heading("experiment", digits=7, absent="not found")]
    frequency_interval: FrequencyInterval
    damping: DampingRatio
    damping_interval: DampingInterval
    widening: Widening

    @property
    def number(self) -> Annotated[int, VIEW, Heading("mode of the record")]:
        """Number of the mode among those identified in the record, from 1."""
        return self.index + 1


@dataclass(frozen=True)
class ComparedMode:
    """Platform mode in model, finite elements and test, with frequencies in Hz.

    `number` counts the platform's modes from 1. `assurance` is the modal assurance criterion (MAC) of model and test at the sensors. For
    repeated modes, `assurance` is the fraction of the measured shape within the model's subspace. `fea_assurance` is the MAC of model and
    finite elements for all motions that exist in the model and in the finite elements. If `fea_assurance` is below 0.8, `fea` is absent.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Theory, FEA and experiment",
        "number name theory fea fea_error experiment.frequency experiment.frequency_interval experiment.widening difference fea_difference "
        "uncertainty assurance fea_assurance experiment.damping",
        notes=(
            "Differences are relative to the measured natural frequency; theory and FEA are undamped. +-: half of the 95 % interval.",
            "MAC: modal assurance criterion of theory and experiment at the sensors; repeated modes are compared as a subspace.",
            INFLATION,
        ),
    )

    number: Annotated[int, Heading("mode")]
    name: str
    theory: Annotated[float, FREQUENCY]
    fea: Annotated[float | None, FREQUENCY, Heading("FEA")] = None
    fea_error: Annotated[float | None, RATIO, Heading("FEA error", digits=2, unit="%")] = None
    fea_assurance: Annotated[float | None, replace(_ASSURANCE, text="MAC of FEA")] = None
    experiment: Measured | None = None
    assurance: Annotated[float | None, _ASSURANCE] = None

    @property
    def difference(self) -> Annotated[float | None, RATIO, _DIFFERENCE]:
        """Frequency of the model divided by the measured frequency, minus one."""
        return None if self.experiment is None else self.theory / self.experiment.frequency - 1.0

    @property
    def fea_difference(self) -> Annotated[float | None, RATIO, replace(_DIFFERENCE, text="FEA difference")]:
        """Frequency of the finite elements divided by the measured frequency, minus one."""
        return None if self.experiment is None or self.fea is None else self.fea / self.experiment.frequency - 1.0

    @property
    def uncertainty(self) -> Annotated[float | None, INNER, RATIO, Heading("+-", digits=2, unit="%")]:
        """Half the width of the 95 % interval, divided by the measured frequency."""
        if self.experiment is None:
            return None
        low, high = self.experiment.frequency_interval
        return 0.5 * (high - low) / self.experiment.frequency


@dataclass(frozen=True)
class RepeatedModes:
    """Repeated modes of the model (numbers from 1), and the largest angle [rad] between model and measured subspaces.

    `angle` is absent if the subspaces have different dimensions, e.g. because fewer modes were identified.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Repeated modes",
        "numbers seen angle",
        notes=("Repeated modes define only a subspace. The largest angle is between the subspaces of theory and experiment.",),
    )

    numbers: Annotated[tuple[int, ...], Heading("modes")]
    seen: Annotated[int, Heading("found in the experiment")]
    angle: Annotated[float | None, ANGLE, Heading("largest angle", digits=3)]


@dataclass(frozen=True)
class FurtherMode:
    """Measured mode that is not a platform mode; if a local mode of the model matches, also this local mode's name and frequency [Hz]."""

    TABLE: ClassVar[Layout] = Layout(
        "Further measured modes",
        "experiment.number experiment.frequency experiment.frequency_interval experiment.widening experiment.damping name theory assurance",
        notes=(
            "Modes of single units, of the ground or of the support. Pairs of local modes are less reliable: they use only the sensors.",
        ),
    )

    experiment: Measured
    name: Annotated[str | None, Heading("paired mode of theory")] = None
    theory: Annotated[float | None, FREQUENCY] = None
    assurance: Annotated[float | None, _ASSURANCE] = None


@dataclass(frozen=True, eq=False)
class Compared(InNotebook):
    """Comparison of model, finite elements and test, mode by mode.

    `modes` are the platform's modes. `further` are measured modes not paired with a platform mode. `sensors` are the outputs at which
    shapes are compared. `data_warnings` lists missing information and unreliable pairings. `misnamed` lists channels that appear exchanged,
    inverted or scaled.
    """

    modes: tuple[ComparedMode, ...]
    repeated: tuple[RepeatedModes, ...]
    further: tuple[FurtherMode, ...]
    sensors: tuple[str, ...]
    model: Annotated[Model, INNER]
    experiment: Annotated[Identified, INNER]
    fea: Annotated[FeaModes | None, INNER]
    data_warnings: tuple[str, ...]
    provenance: str
    misnamed: Annotated[tuple[str, ...], INNER] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the analytical model and on the order of the finite elements."""
        theory = f"Theory: {self.model.value} model."
        if self.fea is None:
            return (theory,)
        error = "error estimated from a lower order" if self.fea.errors else "error not estimated, because there is no coarser result"
        return theory, f"FEA: elements of order {self.fea.order}, {error}."

    @property
    def fea_order(self) -> Annotated[int | None, VIEW]:
        """Polynomial order of the finite elements; null without finite elements."""
        return None if self.fea is None else self.fea.order


@check_arguments
def compare(
    mechanism: Mechanism, experiment: Identified, fea: FeaModes | None = None, *, model: Model = Model.LUMPED, loaded: bool = True
) -> Compared:
    """Compare the platform's modes in the model, in finite elements (optional) and in the test.

    Shapes are compared at the outputs common to record and stage by the modal assurance criterion (MAC, Allemang & Brown 1982). For
    measured shapes, the real part is used. Modes of the model with frequencies within 1 % of each other are compared as one subspace.
    Measured modes are assigned to modes of the model so that the sum of the MACs of all pairs is largest. Frequency differences have a
    small weight, which decides between shapes that the sensors cannot distinguish. Paired frequencies differ by less than a factor of 1.6;
    the MAC of a pair is at least 0.5. Measured modes may also be paired with local modes of the model. If `loaded` is true and the
    permanent load is significant, the model describes the loaded stage (see `load_effect`). Raises `DesignError` if record and stage have
    no output in common.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> compare(double_triangle(), identify(one_mode_record()))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: y: unknown output; ...
    """
    linear = (loaded_model if loaded else read)(mechanism, model)
    if linear is None:
        raise refuse("model", "rigid bodies have no modes", "Use the model lumped or mapped")
    theory = platform_modes(mechanism, linear)
    sensors = shared_sensors(linear, experiment)
    every = first_design(theory.frequencies, 1)
    candidates = _candidates(theory, every, experiment)
    frequencies = every[list(candidates)]
    seen = _normalise(si_shapes(experiment, sensors), linear, sensors)
    own = _shapes_at_sensors(linear, theory, candidates, sensors)
    groups = _groups(frequencies, len(theory.platform))
    bases = [(group, _basis(own[:, group])) for group in groups]
    pairs, likeness = _pair(frequencies, experiment, bases, seen)

    def score(shapes: Array) -> float:
        found, alike = _pair(frequencies, experiment, bases, shapes)
        return sum(float(alike[place, index]) for place, index in found.items()) / max(1, shapes.shape[1])

    doubt = shape_doubt(sensors, seen, score, lambda: _scales(frequencies, experiment, groups, own, seen))
    right = pairs if doubt is None else _pair(frequencies, experiment, bases, unit_length(doubt.put_right(seen)))[0]
    matched = [
        ([candidates[index] for index in group], [right[index] for index in group])
        for group in groups
        if all(index in right for index in group)
    ]
    misnamed = gain_doubts(_residues(mechanism, linear, theory, experiment, sensors, matched=matched, doubt=doubt))
    misnamed = misnamed if doubt is None else (doubt.text, *misnamed)
    rows = _rows(theory, experiment, pairs, likeness)
    rows = rows if fea is None else _add_fea(rows, theory, fea, linear)
    repeated = tuple(_repeated_modes(group, pairs, own, seen) for group in groups if len(group) > 1 and group[-1] < len(rows))
    return Compared(
        modes=rows,
        repeated=repeated,
        further=tuple(_further_modes(theory, candidates, experiment, pairs, likeness)),
        sensors=sensors,
        model=model,
        experiment=experiment,
        fea=fea,
        data_warnings=(*experiment.data_warnings, *(f"{each}." for each in misnamed), *_warnings(rows, repeated, sensors)),
        misnamed=misnamed,
        provenance=f"{theory.provenance}; {experiment.provenance}",
    )


def shared_sensors(model: LinearModel, experiment: Identified) -> tuple[str, ...]:
    """Find the outputs common to record and model; raises `DesignError` if there are none."""
    known = {channel.name for channel in model.outputs}
    found = tuple(channel.name for channel in experiment.outputs if channel.name in known)
    gauges = [channel.name for channel in model.outputs if "." not in channel.name]
    require(
        Finding(channel.name, "unknown output; record and stage have no output in common", suggest_nearest(channel.name, gauges))
        for channel in experiment.outputs
        if not found
    )
    return found


def _candidates(theory: Modes, frequencies: Array, experiment: Identified) -> tuple[int, ...]:
    """Candidate modes of the model: the platform's first, then all others within the measured range."""
    highest = float(np.exp(_FARTHEST)) * max(experiment.frequencies, default=0.0)
    others = (index for index in range(len(frequencies)) if index not in theory.platform and frequencies[index] < highest)
    return (*theory.platform, *others)


def _groups(frequencies: Array, count: int) -> list[list[int]]:
    """Candidates grouped by subspace, the `count` of the platform and others separately, by index."""
    others = clusters(frequencies[count:], _REPEATED)
    return [*clusters(frequencies[:count], _REPEATED), *([count + index for index in group] for group in others)]


def _shapes_at_sensors(model: LinearModel, theory: Modes, candidates: tuple[int, ...], sensors: Sequence[str]) -> Array:
    """Model modes at the sensors (p, n), of unit length; zero for unobservable modes."""
    shapes = first_design(theory.shapes, 2)[:, list(candidates)]
    seen = first_design(model.output, 2)[list(model.output_index(tuple(sensors)))] @ shapes
    size = np.linalg.norm(seen, axis=0)
    return np.where(size > _SILENT * np.max(size), _normalise(seen, model, sensors), 0.0)


def _normalise(shapes: Array, model: LinearModel, sensors: Sequence[str]) -> Array:
    """Unit-length shapes; angles are scaled to lengths by the platform's radius of gyration."""
    units = {channel.name: channel.unit for channel in model.outputs}
    weight = np.array([gyration(model) if units[name] == "rad" else 1.0 for name in sensors])
    return unit_length(weight[:, None] * shapes)


def _pair(frequencies: Array, experiment: Identified, bases: list[tuple[list[int], Array]], seen: Array) -> tuple[dict[int, int], Array]:
    """Measured mode of each model mode, and their similarities (n, k): the share of a measured shape within the mode's subspace.

    `bases` are orthonormal bases (p, m) of the model's groups of modes.
    """
    likeness = np.zeros((len(frequencies), seen.shape[1]))
    for group, basis in bases:
        likeness[group] = np.sum((basis.T @ seen) ** 2, axis=0)
    if not likeness.size:
        return {}, likeness
    apart = np.abs(np.log(experiment.frequencies[None, :] / frequencies[:, None]))
    fitting = (likeness >= _PAIRED) & (apart <= _FARTHEST)
    found = _assign(np.where(fitting, _FAR * apart - likeness, 0.0), fitting)
    return _sort_within_groups(found, [group for group, _ in bases]), likeness


def _assign(cost: Array, fitting: Array) -> dict[int, int]:
    """Column of each row for the least total cost; pairs that do not fit are left out."""
    first, second = scipy.optimize.linear_sum_assignment(cost)
    return {i: j for i, j in zip(first.tolist(), second.tolist(), strict=True) if fitting[i, j]}


def _scales(frequencies: Array, experiment: Identified, groups: list[list[int]], own: Array, seen: Array) -> Array:
    """Measured size of every output relative to the model, modes paired by frequency, because scaled shapes are unsuitable."""
    apart = np.abs(np.log(experiment.frequencies[None, :] / frequencies[:, None]))
    found = _assign(np.minimum(apart, _FARTHEST), apart <= _FARTHEST)
    whole = [group for group in groups if all(index in found for index in group)]
    theory = _sizes(own, whole)
    scales = np.ones(len(own))
    for _ in range(_ROUNDS):  # repeated modes count by size, because scaled channels distort their shapes
        measured = _sizes(unit_length(seen / scales[:, None]), [[found[index] for index in group] for group in whole])
        scales = scales * output_scales(theory, measured)
    return scales


def _sizes(shapes: Array, groups: list[list[int]]) -> Array:
    """Size of every group of modes at every output (p, groups)."""
    sizes = [np.linalg.norm(np.linalg.qr(shapes[:, group])[0], axis=1) for group in groups]
    return np.stack(sizes, axis=1) if sizes else np.zeros((len(shapes), 0))


def _sort_within_groups(found: dict[int, int], groups: list[list[int]]) -> dict[int, int]:
    """Within a subspace the lower measured frequency belongs to the lower mode."""
    ordered = dict[int, int]()
    for group in groups:
        members = sorted(found[index] for index in group if index in found)
        ordered |= dict(zip(group, members, strict=False))
    return ordered


def _residues(
    mechanism: Mechanism,
    model: LinearModel,
    theory: Modes,
    experiment: Identified,
    sensors: Sequence[str],
    *,
    matched: list[tuple[list[int], list[int]]],
    doubt: SuspectedFault | None,
) -> Residues:
    """Modal gains of model and test between shared sensors and inputs, for the `matched` modes of fully identified groups together.

    Outputs are corrected for their suspected faults.
    """
    names = {channel.name for channel in model.inputs}
    columns = [index for index, channel in enumerate(experiment.inputs) if channel.name in names]
    inputs = tuple(experiment.inputs[index].name for index in columns)
    shape = (len(matched), len(sensors), len(inputs))
    if not matched or not inputs:
        return Residues(tuple(sensors), inputs, *np.zeros((2, *shape)), *np.zeros((2, len(inputs)), dtype=bool))
    sizes = np.array([si_size(mechanism, experiment.inputs[index]) for index in columns])
    shapes, drive = first_design(theory.shapes, 2), first_design(model.input_matrix, 2)[:, list(model.input_index(inputs))]
    sense = first_design(model.output, 2)[list(model.output_index(tuple(sensors)))]
    rows = [names_of(experiment.outputs).index(name) for name in sensors]
    seen = np.array([si_factor(experiment.outputs[row]) for row in rows])[:, None] * experiment.shapes[rows]
    seen = seen if doubt is None else doubt.put_right(seen)
    known, volts = np.isfinite(sizes), np.array([is_voltage(experiment.inputs[index].unit) for index in columns], dtype=bool)
    drives = 4.0 * np.pi * experiment.frequencies[:, None] * 1j * experiment.participation[:, columns] / np.where(known, sizes, 1.0)
    own = [(sense @ shapes[:, modes]) @ (shapes[:, modes].T @ drive) for modes, _ in matched]
    found = [np.real(seen[:, modes] @ drives[modes]) for _, modes in matched]
    return normalise(Residues(tuple(sensors), inputs, np.reshape(own, shape), np.reshape(found, shape), known, known & ~volts))


def _basis(shapes: Array) -> Array:
    """Orthonormal basis of the span of shapes; shapes equal at the sensors count once."""
    left, size, _ = np.linalg.svd(shapes, full_matrices=False)
    return left[:, size > max(1e-3 * float(size[0]), 1e-300)]


def _rows(theory: Modes, experiment: Identified, pairs: dict[int, int], likeness: Array) -> tuple[ComparedMode, ...]:
    frequencies = first_design(theory.platform_frequencies, 1)
    rows = (ComparedMode(number + 1, theory.names[index], float(frequencies[number])) for number, index in enumerate(theory.platform))
    return tuple(
        row
        if (mode := pairs.get(number)) is None
        else replace(row, experiment=_measured_mode(experiment, mode), assurance=float(likeness[number, mode]))
        for number, row in enumerate(rows)
    )


def _measured_mode(experiment: Identified, index: int) -> Measured:
    mode = experiment.modes[index]
    return Measured(index, mode.frequency, mode.frequency_interval, mode.damping, mode.damping_interval, mode.widening)


def _further_modes(
    theory: Modes, candidates: tuple[int, ...], experiment: Identified, pairs: dict[int, int], likeness: Array
) -> Iterator[FurtherMode]:
    partners = {measured: place for place, measured in pairs.items()}
    for index in range(len(experiment.frequencies)):
        place = partners.get(index)
        if place is None:
            yield FurtherMode(_measured_mode(experiment, index))
        elif place >= len(theory.platform):
            mode = candidates[place]
            frequency = float(first_design(theory.frequencies, 1)[mode])
            yield FurtherMode(_measured_mode(experiment, index), theory.names[mode], frequency, float(likeness[place, index]))


def _add_fea(rows: tuple[ComparedMode, ...], theory: Modes, fea: FeaModes, model: LinearModel) -> tuple[ComparedMode, ...]:
    pairs = pair_modes(Moving(theory, model), Moving(fea.modes, fea.model))
    return tuple(
        row
        if (pair := pairs.get(theory.platform[row.number - 1])) is None
        else replace(row, fea=pair.frequency, fea_error=_error(fea, pair), fea_assurance=pair.assurance)
        if pair.reliable
        else replace(row, fea_assurance=pair.assurance)
        for row in rows
    )


def _error(fea: FeaModes, pair: Pair) -> float | None:
    return fea.errors[fea.modes.platform.index(pair.index)] if fea.errors and pair.index in fea.modes.platform else None


def _repeated_modes(group: list[int], pairs: dict[int, int], own: Array, seen: Array) -> RepeatedModes:
    members = [pairs[index] for index in group if index in pairs]
    angle = None
    if len(members) == len(group):
        first, second = _basis(own[:, group]), _basis(seen[:, members])
        if first.shape == second.shape:
            cosines = np.linalg.svd(first.T @ second, compute_uv=False)
            angle = float(np.arccos(np.clip(cosines[-1], 0.0, 1.0)))
    return RepeatedModes(tuple(index + 1 for index in group), len(members), angle)


def _warnings(rows: tuple[ComparedMode, ...], repeated: tuple[RepeatedModes, ...], sensors: tuple[str, ...]) -> Iterator[str]:
    if len(sensors) < len(rows):
        yield f"shapes are compared at {len(sensors)} sensors ({', '.join(sensors)}) for {len(rows)} modes: some modes may look the same."
    for row in rows:
        if row.assurance is not None and row.assurance < _TRUSTED:
            yield f"mode {row.number} ({row.name}): unreliable pairing (got a MAC of {row.assurance:.2f}, expected {_TRUSTED})."
    for row in rows:
        if row.fea is None and row.fea_assurance is not None:
            yield f"mode {row.number} ({row.name}): no similar FEA mode (got a MAC of {row.fea_assurance:.2f}, expected {RELIABLE})."
    for group in repeated:
        names = " and ".join(map(str, group.numbers))
        if 0 < group.seen < len(group.numbers):
            yield f"modes {names} are repeated; the experiment shows only {group.seen} of {len(group.numbers)}. Drive other actuators too."
        if group.angle is not None and group.angle > _TURNED:
            angle = f"{np.rad2deg(group.angle):.0f}"
            yield f"modes {names} are repeated; their measured shapes deviate by up to {angle} degrees from those of theory."
    lost = [f"{row.number} ({row.name}, {row.theory:.4g} Hz)" for row in rows if row.experiment is None]
    if lost:
        yield f"modes not found in the experiment: {', '.join(lost)}."
