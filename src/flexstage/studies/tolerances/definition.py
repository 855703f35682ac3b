"""A tolerance study: samples of a design with scatter, and the specification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from flexstage.analysis.assessment.judge import bench_of, value_or_reason
from flexstage.analysis.assessment.measures import Measure
from flexstage.analysis.assessment.requirements import Requirement
from flexstage.analysis.bench import StageResults
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.numbers import Numbers
from flexstage.studies.sweeps.plan import Plan, Sampling, shares
from flexstage.studies.tolerances.crosstalk import Command, PoseMeasure, command, pose_measures, poses
from flexstage.studies.tolerances.scatter import Deviation, Scatter, Target, apply_deviations, sums

_MANY = 64
"""Number of samples for each number with scatter above which the engine of many designs is faster, including the time of its plan."""


@dataclass(frozen=True)
class Copies(Plan):
    """Plan of a tolerance study: `count` samples with all scatter, then `alone` samples for each entry, with scatter of this entry only.

    The samples of single entries are always a Latin hypercube, because they are few. `groups` contains the number of variables of each
    entry.
    """

    alone: int = 0
    groups: tuple[int, ...] = ()

    @property
    def designs(self) -> int:
        """Number of all samples.

        >>> from flexstage.studies.sweeps.plan import Sampling
        >>> Copies(Sampling.SOBOL, 3, count=8, alone=2, groups=(1, 2)).designs
        12
        """
        return self.count + self.alone * len(self.groups)

    def parts(self, start: int, stop: int) -> list[tuple[Plan, int, int, tuple[bool, ...]]]:
        """Split samples into intervals. Returns the plan, the range of samples, and the mask of the varied variables for each interval.

        >>> from flexstage.studies.sweeps.plan import Sampling
        >>> [part[1:] for part in Copies(Sampling.SOBOL, 2, count=8, alone=4, groups=(1, 1)).parts(6, 13)]
        [(6, 8, (True, True)), (0, 4, (True, False)), (0, 1, (False, True))]
        """
        found = []
        edges = [0, self.count, *(self.count + self.alone * (number + 1) for number in range(len(self.groups)))]
        owners = [number for number, size in enumerate(self.groups) for _ in range(size)]
        for block, (low, high) in enumerate(pairwise(edges)):
            first, last = max(start, low), min(stop, high)
            if first < last:
                sampling = self.sampling if block == 0 else Sampling.LATIN_HYPERCUBE
                plan = Plan(sampling, self.dimensions, high - low, seed=self.seed + block)
                moved = tuple(block in (0, owner + 1) for owner in owners)
                found.append((plan, first - low, last - low, moved))
        return found


@dataclass(frozen=True, eq=False, kw_only=True)
class Tolerance(Study):
    """A tolerance study: `scatters` are the entries of `[scatter]`, which define the study's variables; `limits` are the specification.

    `targets` are the numbers with scatter, and the variables that change them. `wanted` is the required yield of each requirement.
    `commanded` contains the nominal matrices for crosstalk at a point; if it is absent, no crosstalk is computed.
    """

    scatters: tuple[Scatter, ...]
    targets: tuple[Target, ...]
    wanted: float
    commanded: Command | None = None

    @property
    def copies(self) -> int:
        """Number of samples with all scatter."""
        return self.plan.count

    @property
    def deviations(self) -> tuple[Deviation, ...]:
        """Variables of all entries, with their distributions."""
        return tuple(one for each in self.scatters for one in each.variables())

    @property
    def owners(self) -> tuple[int, ...]:
        """Index of the entry of each variable."""
        return tuple(number for number, each in enumerate(self.scatters) for _ in each.members)

    @property
    def lines(self) -> tuple[tuple[str, Requirement], ...]:
        """The requirements with their column names. A column is named `limit NAME` if a response NAME has another measure."""
        named = ((line_name(each), each) for each in self.limits)
        return tuple((name if line_name(self.responses.get(name, each)) == name else f"limit {name}", each) for name, each in named)

    @cached_property
    def measures(self) -> Mapping[str, Measure]:
        """Measures of each sample, by name: the responses, and the measures of the specification."""
        return {**self.responses, **{name: each for name, each in self.lines if name not in self.responses}}

    @property
    def columns(self) -> Mapping[str, Measure]:
        """Computed measures of each sample: `measures` and, if crosstalk is requested, poses per unit command."""
        return {**self.measures, **(pose_measures(self.commanded) if self.commanded is not None else {})}

    @property
    def facts(self) -> dict[str, str]:
        """Inputs on which the results depend, as text."""
        plain = {key: fact for key, fact in super().facts.items() if not key.startswith("variables.")}
        point = {} if self.commanded is None else {"crosstalk": f"at {self.commanded.point}"}
        return {**plain, **{f"scatter.{each.name}": repr(each) for each in self.scatters}, **point}

    def sample(self, start: int, stop: int) -> Array:
        """Compute the deviations (n, d) of samples `start` to `stop` (excluded). Entries without scatter in a sample have deviation 0."""
        if not isinstance(self.plan, Copies):
            return super().sample(start, stop)
        rows = []
        for plan, first, last, moved in self.plan.parts(start, stop):
            at = shares(plan, first, last)
            rows.append(np.stack([self.variables[k].at(at[:, k]) * moved[k] for k in range(plan.dimensions)], axis=-1))
        return np.concatenate(rows)

    def mechanism_for(self, values: Array) -> Mechanism:
        """Build the design with deviations (..., d) added to its numbers."""
        return apply_deviations(self.design, self.targets, values)

    @property
    def numbers(self) -> Numbers | None:
        """The numbers that differ between samples; `None` if there are few samples, which are faster to analyse without these numbers."""
        return sums(self.targets, len(self.variables)) if self.plan.designs >= _MANY * len(self.targets) else None

    def evaluate(self, mechanism: Mechanism, names: tuple[str, ...] | None = None) -> tuple[Array | str, ...]:
        """Compute the measures `names` (default: all columns) of a sample or a batch."""
        columns = self.columns
        found = self.measure_on(bench_of(mechanism), tuple(columns[name] for name in (columns if names is None else names)))
        return tuple("no measure" if each is None else each for each in found)

    def measure_on(self, bench: StageResults, wanted: tuple[Measure | None, ...]) -> tuple[Array | str | None, ...]:
        """Evaluate the measures `wanted` from the analysis results `bench` of a stage. The result is None for entries that are None."""
        requested = any(isinstance(each, PoseMeasure) for each in wanted)
        found = {}
        if self.commanded is not None and requested:
            found = dict(zip(pose_measures(self.commanded), poses(bench, self.commanded), strict=True))
        return tuple(
            None if each is None else found[each.key] if isinstance(each, PoseMeasure) else value_or_reason(bench, each) for each in wanted
        )

    def scale(self, factors: tuple[float, ...]) -> Tolerance:
        """Return the study with the deviations of each entry multiplied by a factor."""
        scatters = tuple(
            replace(each, distribution=each.distribution.times(factor)) for each, factor in zip(self.scatters, factors, strict=True)
        )
        return replace(self, scatters=scatters, variables=tuple(one for each in scatters for one in each.variables()))


def line_name(line: Measure) -> str:
    """Return the column name of a requirement's measure.

    >>> from flexstage.analysis.assessment.requirements import requirements
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [line_name(line) for line in requirements(parallelogram())]
    ['stroke.x', 'frequency.platform.1', 'safety']
    """
    return line.key if line.point == PLATFORM else f"{line.key} at {line.point}"


def nominal_command(design: Mechanism, point: str) -> Command:
    """Compute the nominal matrices of a controller for a point. Raises `DesignError` if the strokes do not determine the pose.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> nominal_command(parallelogram(), "platform").coordinates
    ('x',)
    """
    return command(bench_of(design), point)
