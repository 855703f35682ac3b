"""Variables: numbers of a design in a study, and their ranges."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from flexstage.analysis.assessment.sensitivities import override_level
from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number
from flexstage.base.record import INNER, VIEW, Called
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import show
from flexstage.cases.registry import Variant
from flexstage.mechanism.addresses.address import get, set_values
from flexstage.mechanism.addresses.locate import canonical
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism

_STEP = 1e-20


@dataclass(frozen=True)
class Variable:
    """A variable of a study that sets the numbers at all `addresses` to a value from `low` to `high`, in the SI unit of `quantity`.

    If `relative` is true, `low` and `high` are factors on the design's value at each address. If `logarithmic` is true, values are spaced
    by equal ratios. `levels` is the number of values of a grid in the range, ends included. `step` [SI] is the manufacturing increment;
    rounded values are multiples of this increment. If `variant` is specified, `addresses` are parameters of this case, and the design is
    rebuilt from the case's parameters.
    """

    name: str
    addresses: Annotated[tuple[str, ...], INNER]
    quantity: Annotated[Quantity, INNER]
    low: Annotated[float, Called("from")]
    high: Annotated[float, Called("to")]
    relative: bool = False
    logarithmic: bool = False
    levels: int | None = None
    step: float | None = field(default=None, repr=False)
    variant: Annotated[Variant | None, INNER] = None

    @property
    def numbers(self) -> Annotated[tuple[str, ...], VIEW, Called("addresses")]:
        """The design's addresses whose values are set by the variable."""
        return self.addresses if self.variant is None else ()

    @property
    def parameters(self) -> Annotated[tuple[str, ...], VIEW]:
        """The case's parameters whose values are set by the variable."""
        return () if self.variant is None else self.addresses

    @property
    def unit(self) -> Annotated[str, VIEW]:
        """The SI unit of the range; 1 for a relative range."""
        return self.quantity.si

    def at(self, shares: Array) -> Array:
        """Compute values (n,) at fractions (n,) of the range: 0 is low, 1 is high.

        >>> import numpy as np
        >>> from flexstage.base.units.quantity import LENGTH
        >>> Variable("t", ("parts.neck.thickness",), LENGTH, 1e-3, 4e-3, logarithmic=True).at(np.array([0.0, 0.5, 1.0])).round(9).tolist()
        [0.001, 0.002, 0.004]
        """
        if self.logarithmic:
            return self.low * (self.high / self.low) ** shares
        return self.low + (self.high - self.low) * shares

    def text(self, value: float) -> str:
        """Format a value as in a study's file: with its unit, or in percent of the design's value.

        >>> from flexstage.base.units.quantity import RATIO
        >>> Variable("t", ("parts.neck.thickness",), RATIO, 0.9, 1.1, relative=True).text(1.1)
        '+10 %'
        """
        return f"{100.0 * (value - 1.0):+.4g} %" if self.relative else show(value, self.quantity, digits=6)

    def nominal(self, mechanism: Mechanism) -> float:
        """Return the value in the nominal design: 1 for a relative variable, else the value at the first address.

        >>> from flexstage.base.units.quantity import LENGTH
        >>> from flexstage.cases.double_triangle import double_triangle
        >>> Variable("t", ("parts.neck.thickness",), LENGTH, 1e-3, 4e-3).nominal(double_triangle())
        0.00154...
        """
        if self.relative:
            return 1.0
        first = self.addresses[0]
        return float(get(mechanism, first) if self.variant is None else self.variant.value(first))


def apply(mechanism: Mechanism, variables: Iterable[Variable], values: Array) -> Mechanism:
    """Build the design with `values` (..., d) of the variables, in SI. Leading axes of `values` give a batch of designs.

    Whatever the sequence of the variables, parameters of a case are set first, because the design is built from them. The numbers of shared
    parts are written before the numbers that override them.

    >>> import numpy as np
    >>> from flexstage.base.units.quantity import LENGTH
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 1e-3, 2e-3)
    >>> apply(double_triangle(), [neck], np.array([[0.0015], [0.0016]])).parts["neck"].thickness.tolist()
    [0.0015, 0.0016]
    """
    known = tuple(variables)
    return apply_columns(mechanism, known, tuple(values[..., number] for number in range(len(known))))


def apply_columns(mechanism: Mechanism, variables: tuple[Variable, ...], columns: tuple[Number, ...]) -> Mechanism:
    """Build the design from `columns`, the values (...) of each variable. Only complex values make numbers of the design complex.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 1e-3, 2e-3)
    >>> apply_columns(double_triangle(), (neck,), (0.0015,)).parts["neck"].thickness
    0.0015
    """
    moves = [(address, *move) for move in zip(variables, columns, strict=True) for address in move[0].addresses]
    start = _draw(mechanism, [move for move in moves if move[1].variant is not None])
    written = [move for move in moves if move[1].variant is None]
    written.sort(key=lambda move: override_level(mechanism, move[0]))
    return set_values(
        start, [(address, get(start, address) * value if variable.relative else value) for address, variable, value in written]
    )


def _draw(mechanism: Mechanism, moves: list[tuple[str, Variable, Number]]) -> Mechanism:
    """The design built from the varied parameters; unchanged without any."""
    variant = next((variable.variant for _, variable, _ in moves), None)
    if variant is None:
        return mechanism
    return variant.mechanism_at({name: variant.value(name) * value if variable.relative else value for name, variable, value in moves})


def variable_findings(mechanism: Mechanism, variables: Iterable[Variable]) -> Iterator[Finding]:
    """Check variables for empty or inverted ranges, numbers set by two variables, and parameters without effect.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 2e-3, 1e-3)
    >>> [str(each) for each in variable_findings(double_triangle(), [neck])]
    ['variables.neck: the range is empty (got 2 mm to 1 mm). Use from < to.']
    """
    owners = dict[str, str]()
    for variable in variables:
        where = f"variables.{variable.name}"
        if not variable.low < variable.high:
            what = f"the range is empty (got {variable.text(variable.low)} to {variable.text(variable.high)})"
            yield Finding(where, what, "Use from < to")
        elif variable.logarithmic and variable.low <= 0.0:
            yield Finding(
                where, f"a logarithmic range must start above 0 (got {variable.low:g})", "Use a positive start, or a linear range"
            )
        if variable.levels is not None and variable.levels < 2:
            yield Finding(where, f"too few levels (got {variable.levels}, expected at least 2)", "Use 2 levels or more")
        for address in variable.addresses:
            full = canonical(mechanism, address) if variable.variant is None else f"parameter {address}"
            if full in owners:
                yield Finding(where, f"'{address}' is already set by {owners[full]}", "Use one variable")
            owners[full] = variable.name
    yield from _parameter_findings(mechanism, tuple(variables))


def _parameter_findings(mechanism: Mechanism, variables: tuple[Variable, ...]) -> Iterator[Finding]:
    """Parameters without effect on the design, or with a number that an address overwrites."""
    overwritten = {
        canonical(mechanism, address): (variable.name, address)
        for variable in variables
        if variable.variant is None and not variable.relative
        for address in variable.addresses
    }
    for variable in variables:
        if variable.variant is None:
            continue
        where = f"variables.{variable.name}"
        for name in variable.addresses:
            moved = _numbers_moved_by(variable.variant, name)
            if not moved:
                yield Finding(where, f"parameter {name} has no effect on this design", "Use another parameter")
            for address in sorted(moved & set(overwritten)):
                other, text = overwritten[address]
                what = f"parameter {name} sets {text}, and so does variable {other}"
                yield Finding(where, what, "Remove one of them, or use a range in percent for the address")


def _numbers_moved_by(variant: Variant, name: str) -> frozenset[str]:
    """Addresses of the numbers that depend on a parameter."""
    value = variant.value(name)
    stepped = variant.mechanism_at({name: np.asarray(complex(value, abs(value) * _STEP or _STEP))})
    return frozenset(
        address for address, found, _ in node_of(Mechanism).numbers(stepped) if np.iscomplexobj(found) and np.imag(found) != 0.0
    )
