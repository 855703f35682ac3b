"""Variables: the numbers of a design that a study moves, and their ranges."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.base.quantity import Quantity
from flexstage.mechanism.address import get, set_value
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.sensitivities import departure


@dataclass(frozen=True)
class Variable:
    """One number that a study moves from `low` to `high` [SI of `quantity`], written to all its `addresses`.

    `relative`: low and high are factors on what the design states at each address. `logarithmic`: equal steps are equal ratios. `levels`:
    into how many values a grid divides the range, ends included. `step` [SI]: only its multiples can be made.
    """

    name: str
    addresses: tuple[str, ...]
    quantity: Quantity
    low: float
    high: float
    relative: bool = False
    logarithmic: bool = False
    levels: int | None = None
    step: float | None = field(default=None, repr=False)

    def at(self, shares: Array) -> Array:
        """Values (n,) at shares (n,) of the range: 0 is low, 1 is high.

        >>> import numpy as np
        >>> from flexstage.base.quantity import LENGTH
        >>> Variable("t", ("parts.neck.thickness",), LENGTH, 1e-3, 4e-3, logarithmic=True).at(np.array([0.0, 0.5, 1.0])).round(9).tolist()
        [0.001, 0.002, 0.004]
        """
        if self.logarithmic:
            return self.low * (self.high / self.low) ** shares
        return self.low + (self.high - self.low) * shares


def varied(mechanism: Mechanism, variables: Iterable[Variable], values: Array) -> Mechanism:
    """The design with `values` (..., d) of the variables, in SI; with leading axes it is a batch.

    Shared parts are written before departures from them, whatever the order of the variables.

    >>> import numpy as np
    >>> from flexstage.base.quantity import LENGTH
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 1e-3, 2e-3)
    >>> varied(double_triangle(), [neck], np.array([[0.0015], [0.0016]])).parts["neck"].thickness.tolist()
    [0.0015, 0.0016]
    """
    moves = [(address, variable, values[..., number]) for number, variable in enumerate(variables) for address in variable.addresses]
    result = mechanism
    for address, variable, value in sorted(moves, key=lambda move: departure(mechanism, move[0])):
        wanted = get(mechanism, address) * value if variable.relative else value
        result = set_value(result, address, wanted)
    return result


def variable_findings(mechanism: Mechanism, variables: Iterable[Variable]) -> Iterator[Finding]:
    """Ranges that are empty or inverted, and numbers that two variables move.

    >>> from flexstage.base.quantity import LENGTH
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 2e-3, 1e-3)
    >>> [str(each) for each in variable_findings(double_triangle(), [neck])]
    ['variables.neck: its range is empty: from 0.002 to 0.001 m. Give from < to.']
    """
    from flexstage.mechanism.locate import canonical

    owners: dict[str, str] = {}
    for variable in variables:
        where = f"variables.{variable.name}"
        if not variable.low < variable.high:
            what = f"its range is empty: from {variable.low:g} to {variable.high:g} {variable.quantity.si}"
            yield Finding(where, what, "Give from < to")
        elif variable.logarithmic and variable.low <= 0.0:
            yield Finding(where, f"a logarithmic range cannot begin at {variable.low:g}", "Begin above 0, or leave out the logarithm")
        if variable.levels is not None and variable.levels < 2:
            yield Finding(where, f"it has {variable.levels} level", "Give 2 levels or more")
        for address in variable.addresses:
            full = canonical(mechanism, address)
            if full in owners:
                yield Finding(where, f"'{address}' is already moved by {owners[full]}", "Let one variable move it")
            owners[full] = variable.name
