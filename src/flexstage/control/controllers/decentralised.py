"""Decentralised control: one controller with notch filters per loop, and reference feedforward."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.control.controllers.law import Law
from flexstage.control.controllers.loops import Loops
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.prefilter import Prefilter, with_prefilters
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.systems.system import System, block_matrices, select


@dataclass(frozen=True, eq=False)
class Decentralised(CheckedFields):
    """Decentralised controller: a control law with notch filters for each loop, and feedforward of the reference to the strokes.

    The strokes are `loops.drive` times the loops' commands, plus `feedforward` times the reference. `laws`, `notches` and `prefilters` have
    one entry for each loop (default: no notches, no prefilters). `feedforward` (n, f) is the matrix R_a of the ideal kinematics, or gains
    that also correct lost motion (default: no feedforward). A prefilter filters the reference of its loop; the feedforward uses the
    filtered reference. Raises `DesignError` for sizes that do not match.
    """

    loops: Loops
    laws: tuple[Law, ...]
    notches: tuple[tuple[Notch, ...], ...] = ()
    feedforward: Array | None = None
    prefilters: tuple[Prefilter | None, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        require(_findings(self))

    def system(self, step: float | None = None) -> System:
        """Return the controller as a linear system.

        For each coordinate c, the inputs are `error.<c>`, `pose.<c>` (only if a law uses it) and `reference.<c>` (only with `feedforward`
        or `prefilters`). For each actuator, `applied.<actuator>` is a further input: the applied input of the actuator minus its commanded
        input. Outputs are `command.<actuator>`. Raises `DesignError` for a law that is too fast for the sampling rate.

        >>> from flexstage.control.controllers.pi import PI
        >>> from flexstage.control.controllers.loops import platform_loops
        >>> from flexstage.control.plant_models.coordinates import coordinates
        >>> from flexstage.cases.parallelogram import parallelogram
        >>> from flexstage.models.ideal import ideal
        >>> loops = platform_loops(coordinates(ideal(parallelogram())))
        >>> found = Decentralised(loops, (PI(integral=200.0),), feedforward=np.eye(1)).system(1e-3)
        >>> found.input_names, found.output_names
        (('error.x', 'reference.x', 'applied.B'), ('command.B',))
        """
        chains = loop_systems(self, step)
        loops, coordinates = self.loops, self.loops.coordinates
        A, B, C, D = block_matrices(chains)
        # applied strokes, projected on the loops: redundant actuators outnumber the loops
        seen = (loops.sense, loops.sense, np.linalg.pinv(loops.drive))
        found = System(
            A=A,
            B=np.hstack([B[:, column::3] @ map_ for column, map_ in enumerate(seen)]),
            C=loops.drive @ C,
            D=np.hstack([loops.drive @ D[:, column::3] @ map_ for column, map_ in enumerate(seen)]),
            inputs=coordinates.controller_inputs(),
            outputs=coordinates.commands("command."),
            step=step,
        )
        if not np.any(B[:, 1::3]):
            found = select(found, [name for name in found.input_names if not name.startswith("pose.")], found.output_names)
        whole = with_feedforward(found, self.feedforward, coordinates)
        return with_prefilters(whole, self.prefilters, loops.sense, coordinates)


def loop_systems(control: Decentralised, step: float | None = None) -> tuple[System, ...]:
    """Return one system per loop from `error`, `pose` and `applied` to `command` [m]: its control law and its notches in series.

    >>> from flexstage.control.controllers.pi import PI
    >>> from flexstage.control.controllers.loops import platform_loops
    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> loops = platform_loops(coordinates(ideal(parallelogram())))
    >>> found = loop_systems(Decentralised(loops, (PI(integral=200.0),), ((Notch(50.0),),)))
    >>> round(abs(found[0].transfer(np.array([50.0]))[0, 0, 0]), 12).item()
    0.0
    """
    rows = zip(control.laws, control.notches or ((),) * len(control.laws), strict=True)
    return tuple(reduce(filtered, (each.system(step) for each in notches), law.system(step)) for law, notches in rows)


def filtered(law: System, notch: System) -> System:
    """Connect a notch in series with the output of a law. The matrices are composed directly, without `connect`.

    >>> from flexstage.control.controllers.pi import PI
    >>> law = PI(integral=200.0).system()
    >>> filtered(law, Notch(50.0).system()).output_names == law.output_names
    True
    """
    rows, columns = len(law.A), len(notch.A)
    A = np.block([[law.A, np.zeros((rows, columns))], [notch.B @ law.C, notch.A]])
    B = np.vstack([law.B, notch.B @ law.D])
    return replace(law, A=A, B=B, C=np.hstack([notch.D @ law.C, notch.C]), D=notch.D @ law.D)


def with_feedforward(control: System, gains: Array | None, coordinates: Coordinates) -> System:
    """Add feedforward to a controller: `gains` (n, f) times the reference. The inputs `reference.<c>` precede `applied`.

    >>> from flexstage.control.plant_models.coordinates import coordinates
    >>> from flexstage.control.systems.system import static
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.linear.model import Channel
    >>> found = static(np.zeros((1, 1)), (Channel("error.x", "m"),), (Channel("command.B", "m"),))
    >>> with_feedforward(found, np.array([[1.03]]), coordinates(ideal(parallelogram()))).D.tolist()
    [[0.0, 1.03]]
    """
    if gains is None:
        return control
    wanted = coordinates.motions("reference.")
    place = next((number for number, name in enumerate(control.input_names) if name.startswith("applied.")), len(control.inputs))
    return replace(
        control,
        B=np.insert(control.B, [place] * len(wanted), 0.0, axis=1),
        D=np.hstack([control.D[:, :place], np.asarray(gains), control.D[:, place:]]),
        inputs=(*control.inputs[:place], *wanted, *control.inputs[place:]),
    )


def _findings(control: Decentralised) -> Iterator[Finding]:
    count = len(control.loops.names)
    for kind, given in (("control laws", control.laws), ("sets of notches", control.notches), ("prefilters", control.prefilters)):
        if len(given) != count and (given or kind == "control laws"):
            yield Finding(
                "controller", f"{len(given)} {kind} for {count} loops ({', '.join(control.loops.names)})", "Use one for each loop"
            )
    shape = (len(control.loops.coordinates.actuators), len(control.loops.coordinates.names))
    if control.feedforward is not None and np.shape(control.feedforward) != shape:
        what = f"feedforward gains have the wrong shape (got {np.shape(control.feedforward)}, expected {shape}: actuators, coordinates)"
        yield Finding("controller", what, "Use a matrix of strokes per coordinate, like R_a")
