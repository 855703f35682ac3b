"""State-space form of a linear model, for controllers and other programs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Damping, ModalDamping, RayleighDamping
from flexstage.models.linear.damping import law_rates, modal_ratios, viscous_coupling
from flexstage.models.linear.eigen import Eigen, eigen
from flexstage.models.linear.frequency import imposed_on, modal_forces, residual
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.port import Ports


@dataclass(frozen=True, eq=False)
class StateSpace:
    """State space x' = A x + B u, y = C x + D u with A (..., 2k, 2k), B (..., 2k, m), C (..., p, 2k), D (..., p, m) [SI].

    `states` are modal coordinates `mode1`, ... and their rates `mode1'`, ...; `ratios` (..., k) are the damping ratios.

    `note` lists the simplifications.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: tuple[str, ...]
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    ratios: Array
    note: str
    provenance: str

    def transfer(self, frequencies: Array) -> Array:
        """Compute H = C (j omega - A)^-1 B + D (..., f, p, m) at `frequencies` (f,) in Hz."""
        shifted = 2j * np.pi * np.asarray(frequencies)[:, None, None] * np.eye(self.A.shape[-1]) - self.A[..., None, :, :]
        load = np.broadcast_to(self.B[..., None, :, :], (*shifted.shape[:-2], *self.B.shape[-2:]))
        return self.C[..., None, :, :] @ np.linalg.solve(shifted, load) + self.D[..., None, :, :]

    def to_dict(self) -> dict[str, Any]:
        """Return the matrices and names as a plain dictionary, ready for `scipy.io.savemat`."""
        names = {"inputs": self.inputs, "outputs": self.outputs}
        labels = {key: [f"{channel.name} [{channel.unit}]" for channel in channels] for key, channels in names.items()}
        return {"A": self.A, "B": self.B, "C": self.C, "D": self.D, "states": list(self.states), **labels, "note": self.note}


def state_space(model: LinearModel, chosen: Ports, damping: Damping, modes: int | None = None) -> StateSpace:
    """Build the modal state space between chosen ports, with the lowest `modes` modes (default: all). Higher modes are static terms in D.

    The modal coordinates eta satisfy eta'' + R eta' + omega^2 eta = Phi^T B u - Phi^T M_b u''. Phi are the mode shapes, B and M_b the
    forces per input u and per u''. R is the modal damping 2 zeta omega plus the dampers of parts, Phi^T D Phi.

    With ground displacement as input, the states are eta + Phi^T M_b u, so that no input is differentiated.

    Modal damping is represented exactly. Rayleigh damping is also exact, except that the static response of omitted modes is undamped.
    Structural damping has no time-domain form; each mode has its equivalent damping ratio, as `note` says.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> space = state_space(model, ports(model, ["S"], ["B"]), model.damping, modes=6)
    >>> space.A.shape, space.note
    ((12, 12), 'modal damping, exact; modes above the first 6 as a static term')
    """
    solved = _lowest(eigen(model), modes)
    rate = _square(law_rates(model, solved, damping)) + viscous_coupling(model, solved)
    force, inertial = modal_forces(solved, chosen)
    output = chosen.output @ solved.shapes
    carried = rate @ inertial + _damped_by_inputs(model, solved, chosen)
    lower = force + solved.values[..., None] * inertial - rate @ carried
    zero = np.zeros_like(output)
    return StateSpace(
        A=_dynamics(solved.values, rate),
        B=np.concatenate(np.broadcast_arrays(carried, lower), axis=-2),
        C=np.concatenate([output, zero], axis=-1),
        D=chosen.feedthrough + residual(model, solved, chosen) - output @ inertial,
        states=tuple(f"mode{number + 1}{mark}" for mark in ("", "'") for number in range(solved.values.shape[-1])),
        inputs=chosen.inputs,
        outputs=chosen.outputs,
        ratios=modal_ratios(model, solved, damping),
        note=_note(model, damping, modes),
        provenance=model.provenance,
    )


def _lowest(solved: Eigen, modes: int | None) -> Eigen:
    return solved if modes is None else replace(solved, values=solved.values[..., :modes], shapes=solved.shapes[..., :modes])


def _square(diagonal: Array) -> Array:
    return diagonal[..., None] * np.eye(diagonal.shape[-1])


def _damped_by_inputs(model: LinearModel, solved: Eigen, chosen: Ports) -> Array:
    """Forces of dampers on the modes per rate of the inputs (..., k, m): imposed deformations are damped too."""
    total: Array = np.zeros((solved.shapes.shape[-1], len(chosen.inputs)))
    for name, law in model.viscous.items():
        strain = model.stiffness[name].operator[..., : law.shape[-1], :] @ solved.shapes
        total = total + strain.mT @ law @ imposed_on(model, name, chosen)
    return total


def _dynamics(values: Array, rate: Array) -> Array:
    """A = [[0, I], [-Lambda, -R]], R = 2 Z Omega + Phi^T D Phi."""
    count = values.shape[-1]
    result = np.zeros((*np.broadcast_shapes(values.shape[:-1], rate.shape[:-2]), 2 * count, 2 * count))
    result[..., :count, count:] = np.eye(count)
    result[..., count:, :count] = -values[..., None] * np.eye(count)
    result[..., count:, count:] = -rate
    return result


def _note(model: LinearModel, damping: Damping, modes: int | None) -> str:
    dampers = f"; dampers of {', '.join(model.viscous)} between the retained modes" if model.viscous else ""
    return f"{_law_note(damping, modes)}{dampers}"


def _law_note(damping: Damping, modes: int | None) -> str:
    left = "DOFs without inertia" if modes is None else f"modes above the first {modes}"
    if isinstance(damping, ModalDamping):
        return f"modal damping, exact; {left} as a static term"
    if isinstance(damping, RayleighDamping):
        return f"Rayleigh damping as exact modal ratios; {left} as an undamped static term"
    return f"structural damping replaced by equivalent modal ratios (modal strain energy); {left} as a static term"
