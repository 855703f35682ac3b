"""The fields of each section of a study's file. The reader and the schema are generated from these fields."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from flexstage.base.finding import DesignError
from flexstage.base.storage.digest import KEY
from flexstage.base.units.quantity import RATIO, Bound, Quantity
from flexstage.mechanism.grammar.grammar import OpenNode
from flexstage.mechanism.grammar.node import AmountNode, ChoiceNode, NumberNode, TextsNode
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.mechanism.store.decode import record_from
from flexstage.mechanism.store.file import parse_toml
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.schema import schema_of
from flexstage.studies.sweeps.plan import Sampling

FORMAT = "flexstage study 1"
COPIES_BY = (Sampling.MONTE_CARLO, Sampling.LATIN_HYPERCUBE, Sampling.SOBOL)

Amount = Annotated[str | float, AmountNode()]
Texts = Annotated[tuple[str, ...], TextsNode()]
Parameters = Annotated[Mapping[str, Any], OpenNode("New values of the case's parameters, by name.")]

_ONE, _TWO, _THREE = Bound(low=1.0), Bound(low=2.0), Bound(low=3.0)
_SEED = Bound(low=0.0)
_YIELD = Bound(low=0.5, high=1.0, open_low=True, open_high=True)


@dataclass(frozen=True)
class VariedTable:
    """A variable of a study: one or several numbers of the design (`address`), or parameters of the case (`parameter`).

    If a variable has several numbers, they change together. Without `address` and `parameter`, the variable's name is the address. `from`
    and `to` are the ends of the range, with units or in percent of the design's value. If `logarithmic` is true, values are spaced by equal
    ratios. `levels` is the number of values in a grid. `step` is the manufacturing increment; rounded values are multiples of this
    increment.
    """

    low: Amount = field(metadata={KEY: "from"})
    high: Amount = field(metadata={KEY: "to"})
    address: Texts | None = None
    parameter: Texts | None = None
    logarithmic: bool = False
    levels: Annotated[int, _TWO] | None = None
    step: Amount | None = None


@dataclass(frozen=True)
class SweepTable:
    """Sampling of designs: kind of `sampling`, number of `designs`, random `seed`.

    The default number of designs is 1024; for a grid, the levels of the variables define the number. If `pairs` is true, Saltelli's plan
    also provides second-order Sobol indices.
    """

    sampling: Sampling = Sampling.SOBOL
    designs: Annotated[int, _ONE] | None = None
    seed: Annotated[int, _SEED] = 0
    pairs: bool = False


@dataclass(frozen=True)
class OptimiseTable:
    """Objectives: responses to `maximise` or `minimise`. With two objectives, a Pareto front of `pareto_points` designs is computed.

    `starts` is the number of initial designs, chosen with the random `seed`. If `requirements` is true, the requirements of the design file
    are also limits.
    """

    maximise: Texts | None = None
    minimise: Texts | None = None
    starts: Annotated[int, _ONE] = 3
    seed: Annotated[int, _SEED] = 0
    pareto_points: Annotated[int, _THREE] = 9
    requirements: bool = True


@dataclass(frozen=True)
class ScatterTable:
    """Scatter of numbers of one physical quantity, at one or several addresses (`address`). By default, the entry's name is the address.

    The distribution is normal with the standard deviation `normal`, or uniform with the half width `uniform`. `normal` and `uniform` have a
    unit or are in percent of the design's value. `within` is the deviation at which a normal distribution is truncated. `interval` is an
    asymmetric tolerance (lower, upper) with a uniform distribution. If `normal` is also specified, the distribution is normal about the
    middle of the interval and truncated at its ends. If `independent` is true, every instance has its own deviation.
    """

    address: Texts | None = None
    normal: Amount | None = None
    uniform: Amount | None = None
    within: Amount | None = None
    interval: tuple[Amount, Amount] | None = None
    independent: bool = False


@dataclass(frozen=True)
class ToleranceTable:
    """Number of `copies` (samples), their `sampling` and `seed`, and the required `yield` of each requirement.

    If `requirements` is true, the requirements of the design file are included. If `crosstalk` is true, the platform's crosstalk at the
    `point` is computed. By default, crosstalk is computed if the strokes determine the platform's pose.
    """

    copies: Annotated[int, _TWO] = 1024
    seed: Annotated[int, _SEED] = 0
    sampling: Annotated[Sampling, ChoiceNode(Sampling, COPIES_BY)] = COPIES_BY[0]
    yield_: Annotated[float, RATIO, _YIELD] = field(default=0.99, metadata={KEY: "yield"})
    requirements: bool = True
    crosstalk: bool | None = None
    point: str = PLATFORM


@dataclass(frozen=True, kw_only=True)
class StudyFile:
    """A study: its initial design (`design` file, or shipped `case` with `parameters`), its responses and its limits.

    `responses` contains a measure for each name. `limits` contains a text with "at least" or "at most" for each measure. A sweep uses
    `variables` and `sweep`. An optimisation uses `variables` and `optimise`. A tolerance analysis uses `scatter` and `tolerance`.
    """

    name: str = "study"
    design: str | None = None
    case: str | None = None
    parameters: Parameters
    variables: Mapping[str, VariedTable]
    responses: Mapping[str, str]
    limits: Mapping[str, str]
    scatter: Mapping[str, ScatterTable]
    sweep: SweepTable = field(default_factory=SweepTable)
    optimise: OptimiseTable = field(default_factory=OptimiseTable)
    tolerance: ToleranceTable = field(default_factory=ToleranceTable)


def study_file(text: str, where: str) -> StudyFile:
    """Parse the text of a study's file. Raises `DesignError` with all errors of the text.

    >>> study_file('format = "flexstage study 1"' + chr(10) + 'case = "parallelogram"', "here").sweep.seed
    0
    """
    raw = parse_toml(text, where)
    try:
        return record_from(StudyFile, raw, FORMAT, tagged=False)
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None


def study_schema() -> dict[str, Any]:
    """Return the JSON Schema of a study's file, for editors.

    >>> study_schema()["$defs"]["VariedTable"]["required"]
    ['from', 'to']
    """
    return schema_of(StudyFile, FORMAT, "flexstage study", tagged=False)


def is_share(raw: str | float) -> bool:
    """Return whether an amount is in percent of the design's value.

    >>> is_share("-10 %"), is_share("1.4 mm")
    (True, False)
    """
    return isinstance(raw, str) and raw.strip().endswith("%")


def parse_amount(raw: str | float, quantity: Quantity, where: str) -> float:
    """Convert an amount to SI units. Raises `DesignError` with the address `where` if the unit belongs to another quantity.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> parse_amount("1.5 mm", LENGTH, "variables.neck.from")
    0.0015
    """
    return NumberNode(quantity).si(raw, where)
