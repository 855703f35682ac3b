"""Static condensation of a stage into an amplified actuator of another stage."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.linear_statics.statics import statics
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array, Number, stack
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts.actuator import ChargedActuator, StrokeActuator
from flexstage.parts.amplified import Amplified
from flexstage.spatial.frame import COMPONENTS


@check_arguments
def amplified(mechanism: Mechanism) -> Amplified:
    """Condense a stage into one part. The stage's ground is the part's first face, and the stage's platform is the second face.

    The lumped model gives, at the platform's reference point, the compliance with the stroke fixed and the motion at full stroke. The
    part's centre is the platform's reference point, and its axes are the stage's axes. For a link with this part, `along` is the stage's x
    direction, and `bends` is the stage's z direction. Voltages, bias and capacitance are taken from the stage's single actuator. Each of
    the two faces has half of the mass of all bodies and links.

    The part has the stage's exact static behaviour. The part has no internal modes; therefore it is valid only well below the first
    internal mode with both faces fixed. Loads and preload of the actuator are ignored. Raises `DesignError` unless the stage has exactly
    one actuator, which must be a stroke actuator.

    >>> from flexstage.cases.registry import case
    >>> part = amplified(case("bridge"))
    >>> part.deformation[1] < 0.0, part.capacitance == case("bridge").parts["stack"].capacitance
    (True, True)
    """
    assembly, model = expand(mechanism), lumped(mechanism)
    own = assembly.actuator(next(iter(assembly.actuators))) if len(assembly.actuators) == 1 else None
    if not isinstance(own, StrokeActuator):
        result = ", ".join(assembly.actuators) or "none"
        raise refuse("actuators", f"wrong number of actuators (got {result}, expected one stroke actuator)", "Use a stage with one stack")
    twist = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
    moved = static_gain(model, twist, model.strokes).values[..., 0] * np.asarray(own.stroke)[..., None]
    charged = own if isinstance(own, ChargedActuator) else None
    return Amplified(
        stroke=_number(np.sqrt(np.sum(moved[..., :3] ** 2, axis=-1))),
        deformation=tuple(_number(moved[..., index]) for index in range(6)),  # type: ignore[arg-type]
        compliance=_rows(statics(model).compliance.values),
        mass=_number(_whole_mass(assembly)),
        voltage_low=None if charged is None else charged.voltage_low,
        voltage_high=None if charged is None else charged.voltage_high,
        bias=None if charged is None else charged.bias,
        capacitance=None if charged is None else charged.capacitance,
        source=f"{mechanism.name}, {model.provenance}",
    )


def _whole_mass(assembly: Assembly) -> Array:
    bodies = [np.asarray(body.mass.mass) for body in assembly.bodies.values() if body.mass is not None]
    ends = [mass(link.part, link.material) for link in assembly.links.values()]
    links = [each[..., 0, 0] + each[..., 0, 6] + each[..., 6, 0] + each[..., 6, 6] for each in ends]
    return sum([*bodies, *links], np.asarray(0.0))


def _number(value: Array) -> Number:
    return value if value.ndim else value.item()


def _rows(matrix: Array) -> tuple[tuple[Number, ...], ...]:
    """Rows of numbers of a matrix, symmetrised."""
    even = 0.5 * (matrix + matrix.mT)
    return tuple(tuple(_number(stack(even[..., row, column])) for column in range(6)) for row in range(6))
