"""Platform frequencies of thousands of designs per second. The computation is planned once for a study, then used for all its designs.

The method for a design, and the choice whether the data of designs are fitted over the ranges, depend only on the study. They depend
neither on the division into pieces, nor on the number of remaining designs.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.analysis.assessment.measures import platform_frequency
from flexstage.base.finding import DesignError
from flexstage.base.number import Array, Table
from flexstage.base.version import __version__
from flexstage.models.batch.engine import Plan, Status, plan_family, platform_modes
from flexstage.models.batch.family import Family, drawn_family, family
from flexstage.models.batch.kernel import kernel_name
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.loaded import needs_load_check
from flexstage.studies.sweeps.numbers import Numbers

_MODES = 6
_FIT = 4_700
"""Cost of fitting, in descriptions, with `_EACH` more for every number. A fit requires at least `_TIMES` as many further designs."""
_EACH = 34
_TIMES = 4
_BEYOND = 1e-9
"""Extension of a range at both ends, against rounding."""
_SURE = (Status.ITERATED, Status.WHOLE)


@dataclass(frozen=True, eq=False)
class Engine:
    """The engine of a study.

    `modes` contains the number of the platform mode, counted from 0, for each response that the engine computes; it is empty without a
    `plan`. The inputs of the plan are `numbers` if present, else the variables. If `loaded` is true, designs may be unstable under their
    permanent load.
    """

    modes: Mapping[str, int]
    plan: Plan | None = None
    numbers: Numbers | None = None
    loaded: bool = False

    def answers(self, values: Array) -> tuple[Array, Array]:
        """Compute frequencies (n, m) [Hz] of the m responses for designs with `values` (n, d), and the mask (n,) of valid designs.

        An invalid design may have too few modes, or a rigid-body motion. A separate evaluation of an invalid design then provides the
        reason.

        >>> from flexstage.studies.sweeps.example import neck_study
        >>> engine_of(neck_study()).answers(np.array([[0.00154]]))[0].round(1).tolist()
        [[106.0]]
        """
        if self.plan is None:
            return np.zeros((len(values), 0)), np.ones(len(values), dtype=bool)
        found = platform_modes(self.plan, values if self.numbers is None else self.numbers.at(values))
        return found.frequencies[:, list(self.modes.values())], np.isin(found.status, _SURE)

    @property
    def provenance(self) -> str:
        """Versions of the programs. Equal versions give bit-identical results.

        >>> Engine(Table({})).provenance
        'flexstage ..., numpy ... on ...'
        """
        solver = "" if self.plan is None else f", {kernel_name()}"
        return f"flexstage {__version__}, numpy {np.__version__}, scipy {scipy.__version__} on {platform.machine()}{solver}"


def engine_covers(study: Study) -> bool:
    """Return whether the engine supports a study.

    The study must use the standard `mechanism_for`, define its own `mechanism_at` (which must accept complex values), or have `numbers`.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> engine_covers(neck_study())
    True
    """
    kind = type(study)
    return kind.mechanism_for is Study.mechanism_for or kind.mechanism_at is not Study.mechanism_at or study.numbers is not None


def engine_of(study: Study) -> Engine:
    """Make the engine of a study: its plan for fast computation, fitted over the variables' ranges if the study has enough designs.

    The engine is empty for studies that it does not cover (`engine_covers`); dense matrices are then used. Never raises an error.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> dict(engine_of(neck_study()).modes)
    {'tilt': 0}
    """
    wanted = {name: int(each.name) - 1 for name, each in study.columns.items() if each.kind is platform_frequency}
    modes = Table({name: mode for name, mode in wanted.items() if mode < _MODES})
    numbers, loaded = study.numbers, needs_load_check(study)
    if modes and engine_covers(study):
        with suppress(DesignError):
            return Engine(modes, plan_family(_family(study, numbers), ranges=_ranges(study, numbers)), numbers, loaded)
    return Engine(Table({}), loaded=loaded)


def _family(study: Study, numbers: Numbers | None) -> Family:
    if numbers is not None:
        return family(study.design, numbers.addresses)
    nominal = np.clip([each.nominal(study.design) for each in study.variables], *_ends(study))
    return drawn_family(study.mechanism_at, tuple(each.name for each in study.variables), nominal)


def _ends(study: Study) -> Array:
    """Smallest and largest values (2, d) of the variables."""
    return np.array([[each.low, each.high] for each in study.variables]).T


def _ranges(study: Study, numbers: Numbers | None) -> tuple[Array, Array] | None:
    """Ranges of the fitted descriptions."""
    low, high = _ends(study)
    if study.plan.designs < _TIMES * (_FIT + _EACH * (len(low) if numbers is None else len(numbers.addresses))):
        return None
    more = _BEYOND * (high - low)
    return (low - more, high + more) if numbers is None else numbers.ranges(low, high)
