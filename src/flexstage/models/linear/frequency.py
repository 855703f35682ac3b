"""Frequency response of a linear model between named inputs and outputs."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np

from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array
from flexstage.base.processes.memory import require_memory
from flexstage.base.record import INNER, VIEW, Axes, Called
from flexstage.base.units.quantity import FREQUENCY
from flexstage.mechanism.mechanism import Damping, RayleighDamping, StructuralDamping
from flexstage.models.linear.damping import law_rates, structural_stiffness
from flexstage.models.linear.eigen import Eigen, eigen
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.port import Ports

_CHUNK = 4_000_000


class Response(Result):
    """Frequency response: complex `values` (..., f, p, m), H_ij is output i divided by input j, for e^{+j omega t}.

    `frequencies` (f,) are in Hz. `outputs` and `inputs` have names and units; the unit of an entry is output unit / input unit. Batch axes
    come first.
    """

    frequencies: Annotated[Array, FREQUENCY, Called("frequency")]
    outputs: Annotated[tuple[Channel, ...], INNER]
    inputs: Annotated[tuple[Channel, ...], INNER]
    values: Array
    provenance: str

    def at(self, output: str, input: str) -> Array:  # noqa: A002 the field's word
        """Return one entry of the response as a function of frequency, complex (..., f).

        >>> one = Response(np.array([1.0]), (Channel("x", "m"),), (Channel("fx", "N"),), np.array([[[2j]]]), "")
        >>> one.at("x", "fx").tolist()
        [2j]
        """
        row = [channel.name for channel in self.outputs].index(output)
        column = [channel.name for channel in self.inputs].index(input)
        return self.values[..., row, column]

    @property
    def units(self) -> Annotated[tuple[tuple[str, ...], ...], VIEW, Called("unit"), Axes("rows", "columns")]:
        """Unit of every entry, outputs x inputs."""
        return ratio_units(tuple(channel.unit for channel in self.outputs), tuple(channel.unit for channel in self.inputs))

    def matrix(self, index: int) -> Matrix:
        """Return the labelled complex matrix (..., p, m) at a frequency index."""
        return Matrix(self.values[..., index, :, :], self.rows, self.columns, self.units)

    @property
    def rows(self) -> Annotated[tuple[str, ...], VIEW]:
        """Names of the outputs."""
        return tuple(channel.name for channel in self.outputs)

    @property
    def columns(self) -> Annotated[tuple[str, ...], VIEW]:
        """Names of the inputs."""
        return tuple(channel.name for channel in self.inputs)

    @property
    def real(self) -> Annotated[Array, VIEW, Axes("frequencies", "rows", "columns")]:
        """Real part of each entry at each frequency."""
        return np.real(self.values)

    @property
    def imaginary(self) -> Annotated[Array, VIEW, Axes("frequencies", "rows", "columns")]:
        """Imaginary part of each entry at each frequency."""
        return np.imag(self.values)

    def to_xarray(self) -> Any:
        """Return the response as an xarray DataArray with dimensions (batch..., frequency, output, input)."""
        import xarray

        batch = [f"batch_{number}" for number in range(self.values.ndim - 3)]
        axes = {"output": list(self.rows), "input": list(self.columns)}
        return xarray.DataArray(self.values, dims=[*batch, "frequency", "output", "input"], coords={"frequency": self.frequencies, **axes})


def transfer(model: LinearModel, chosen: Ports, frequencies: Array, damping: Damping) -> Array:
    """Compute the frequency response H (..., f, p, m) = y/u at `frequencies` (f,) in Hz.

    The model is M z'' + D z' + K z = B u - M_b u'', y = C z + D_f u. The method of solution depends on the damping:

    - Modal and Rayleigh damping: exact superposition of all modes, H = C Phi d^-1 Phi^T (B + omega^2 M_b) + R B + D_f. Here d has the
      diagonal omega_r^2 - omega^2 + 2 j zeta_r omega_r omega. The residual R = C K^-1 - C Phi Lambda^-1 Phi^T is the response of DOFs
      without inertia; for Rayleigh damping, it is divided by 1 + j omega beta.
    - Structural damping: direct solution at each frequency with the matrix K* - omega^2 M. A stroke u of part p exerts K_p (1 + j eta_p) u;
      the part's force has the same loss factor eta_p.
    - Dampers of parts (`LinearModel.viscous`), with any damping law: direct solution at each frequency, because dampers couple modes.

    A frequency of zero gives the static gain.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.linear.static import static_gain
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> still = transfer(model, ports(model, ["platform.x"], ["B"]), np.array([0.0]), model.damping)
    >>> bool(np.allclose(still[0], static_gain(model, ("platform.x",), ("B",)).values))
    True
    """
    frequencies = np.asarray(frequencies, dtype=float)
    lines, outputs, inputs = max(1, len(frequencies)), len(chosen.outputs), len(chosen.inputs)
    each = 16.0 * math.prod(model.designs) * (outputs * (2 * len(model.coordinates) + 3 * inputs) + 1)
    require_memory(
        "response",
        f"{lines:,} frequencies of {outputs:,} outputs and {inputs:,} inputs",
        each * lines,
        lambda memory: f"Request {int(memory / each):,} frequencies at most, or fewer outputs and inputs",
    )
    if isinstance(damping, StructuralDamping):
        return _structural(model, chosen, frequencies)
    return superpose(model, chosen, frequencies, damping)


def _structural(model: LinearModel, chosen: Ports, frequencies: Array) -> Array:
    lossy = replace(chosen, force=chosen.force + 1j * chosen.lost)
    stiffness = structural_stiffness(model)
    if model.viscous:
        responses = _with_dampers(model, lossy, frequencies, StructuralDamping(), stiffness)
    else:
        responses = direct(stiffness, model.inertia_matrix, lossy, frequencies)
    return responses * (1.0 + 1j * np.asarray(chosen.loss))[..., None, :, None]


def _with_dampers(model: LinearModel, chosen: Ports, frequencies: Array, damping: Damping, stiffness: Array) -> Array:
    """H (..., f, p, m) by direct solutions for parts with dampers: M z'' + (D_law + D) z' + K z = B u + G^T D_p imposed u' - M_b u''.

    D_law is alpha M + beta K, or M Phi diag(2 zeta omega) Phi^T M; zero for a complex `stiffness`.
    """
    resisted: Array = np.zeros((len(model.coordinates),) * 2)
    dragged: Array = np.zeros((len(model.coordinates), len(chosen.inputs)))
    for name, law in model.viscous.items():
        rows = model.stiffness[name].operator[..., : law.shape[-1], :]
        push = rows.mT @ law
        resisted = resisted + push @ rows
        dragged = dragged + push @ imposed_on(model, name, chosen)
    if not np.iscomplexobj(stiffness):
        resisted = resisted + _law_matrix(model, damping)
    return direct(stiffness, model.inertia_matrix, chosen, frequencies, Dampers(resisted, dragged))


def _law_matrix(model: LinearModel, damping: Damping) -> Array:
    """Damping matrix (..., n, n) [N s/m] of a damping law."""
    if isinstance(damping, RayleighDamping):
        mass, stiffness = (np.asarray(factor)[..., None, None] for factor in (damping.mass_factor, damping.stiffness_factor))
        return mass * model.inertia_matrix + stiffness * model.stiffness_matrix
    solved = eigen(model)
    momenta = model.inertia_matrix @ solved.shapes
    return (momenta * law_rates(model, solved, damping)[..., None, :]) @ momenta.mT


def imposed_on(model: LinearModel, name: str, chosen: Ports) -> Array:
    """Return the deformation (..., d, m) that the chosen inputs impose on a link; d is 6, or the number of rows of its damper.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> imposed_on(model, "B/pzt", ports(model, ["S"], ["B", "ground.x"])).tolist()[0]
    [1.0, 0.0]
    """
    own = {channel.name: number for number, channel in enumerate(model.inputs)}
    rows = model.viscous[name].shape[-1] if name in model.viscous else 6
    imposed = model.imposed.get(name, np.zeros((rows, len(model.inputs))))[..., :rows, :]
    columns = [imposed[..., own[each.name]] if each.name in own else np.zeros(imposed.shape[:-1]) for each in chosen.inputs]
    return np.stack(columns, axis=-1)


@dataclass(frozen=True, eq=False)
class Dampers:
    """Damping matrix (..., n, n) of the coordinates, and forces (..., n, m) that dampers transmit per unit velocity of each input."""

    resisted: Array
    dragged: Array


def direct(stiffness: Array, inertia: Array, chosen: Ports, frequencies: Array, dampers: Dampers | None = None) -> Array:
    """Compute H (..., f, p, m) by solving (K - omega^2 M) z = (B + omega^2 M_b) u at each frequency; K may be complex.

    `dampers` add j omega times their damping matrix on the left-hand side, and their input forces on the right-hand side.

    >>> one, none = np.ones((1, 1)), np.zeros((1, 1))
    >>> force = Ports((Channel("fx", "N"),), (Channel("x", "m"),), one, none, one, none)
    >>> direct(4.0 * one, one, force, np.array([0.0])).tolist()
    [[[0.25]]]
    """
    omega = 2.0 * np.pi * frequencies
    size = max(1, int(_CHUNK / max(1, stiffness.size)))
    pieces = [_direct(stiffness, inertia, chosen, omega[start : start + size], dampers) for start in range(0, len(omega), size)]
    return np.concatenate(pieces, axis=-3)


def _direct(stiffness: Array, inertia: Array, chosen: Ports, omega: Array, dampers: Dampers | None) -> Array:
    square = (omega**2)[:, None, None]
    dynamic = stiffness[..., None, :, :] - square * inertia[..., None, :, :]
    load = chosen.force[..., None, :, :] + square * chosen.inertial[..., None, :, :]
    if dampers is not None:
        rate = 1j * omega[:, None, None]
        dynamic, load = dynamic + rate * dampers.resisted[..., None, :, :], load + rate * dampers.dragged[..., None, :, :]
    batch = np.broadcast_shapes(dynamic.shape[:-2], load.shape[:-2])
    motion = np.linalg.solve(np.broadcast_to(dynamic, (*batch, *dynamic.shape[-2:])), np.broadcast_to(load, (*batch, *load.shape[-2:])))
    return chosen.output[..., None, :, :] @ motion + chosen.feedthrough[..., None, :, :]


def superpose(model: LinearModel, chosen: Ports, frequencies: Array, damping: Damping) -> Array:
    """Compute H (..., f, p, m) by modal superposition. Unlike in `transfer`, structural damping is represented by equivalent modal ratios.

    The result agrees with the time-domain model (`state_space`).

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.mechanism import StructuralDamping
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> far, chosen = np.array([1.0]), ports(model, ["platform.x"], ["B"])
    >>> ways = [function(model, chosen, far, StructuralDamping()) for function in (superpose, transfer)]
    >>> bool(np.allclose(*ways, rtol=0.05)), bool(np.allclose(*ways, rtol=1e-6))
    (True, False)
    """
    if model.viscous:
        return _with_dampers(model, chosen, frequencies, damping, model.stiffness_matrix)
    solved = eigen(model)
    omega = 2.0 * np.pi * frequencies
    square = (omega**2)[:, None, None]
    output = (chosen.output @ solved.shapes)[..., None, :, :]
    gains = 1.0 / _denominators(model, solved, omega, damping)
    force, inertial = modal_forces(solved, chosen)
    response = (output * gains[..., None, :]) @ (force[..., None, :, :] + square * inertial[..., None, :, :])
    fast = 1.0 / (1.0 + 1j * omega * _stiffness_factor(damping))[..., None, None]
    remainder = residual(model, solved, chosen)[..., None, :, :]
    return response + fast * remainder + chosen.feedthrough[..., None, :, :]


def modal_forces(solved: Eigen, chosen: Ports) -> tuple[Array, Array]:
    """Compute Phi^T B and Phi^T M_b (..., k, m): modal forces per input and, with opposite sign, per input acceleration.

    >>> one = np.ones((1, 1))
    >>> force = Ports((Channel("fx", "N"),), (Channel("x", "m"),), 3.0 * one, 0.0 * one, one, 0.0 * one)
    >>> modal_forces(Eigen(np.array([4.0]), one), force)[0].tolist()
    [[3.0]]
    """
    transposed = solved.shapes.mT
    return transposed @ chosen.force, transposed @ chosen.inertial


def residual(model: LinearModel, solved: Eigen, chosen: Ports) -> Array:
    """Compute C (K^-1 - Phi Lambda^-1 Phi^T) B (..., p, m): the static residual of omitted modes and of DOFs without inertia.

    Ground motion has no residual, because M_b is in the range of M, which the modes span.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.linear.port import ports
    >>> from flexstage.models.lumped import lumped
    >>> model = lumped(parallelogram())
    >>> bool(np.abs(residual(model, eigen(model), ports(model, ["platform.x"], ["B"]))) < 1e-9)  # every freedom has inertia
    True
    """
    batch = np.broadcast_shapes(model.stiffness_matrix.shape[:-2], chosen.force.shape[:-2])
    motion = model.solve(np.broadcast_to(chosen.force, (*batch, *chosen.force.shape[-2:])))
    elastic = np.where(solved.values == 0.0, np.inf, solved.values)
    modal = solved.shapes.mT @ chosen.force / elastic[..., :, None]
    return chosen.output @ (motion - solved.shapes @ modal)


def _denominators(model: LinearModel, solved: Eigen, omega: Array, damping: Damping) -> Array:
    """omega_r^2 - omega^2 + 2 j zeta_r omega_r omega, (..., f, k)."""
    rate = law_rates(model, solved, damping)
    return solved.values[..., None, :] - (omega**2)[:, None] + 1j * omega[:, None] * rate[..., None, :]


def _stiffness_factor(damping: Damping) -> Array:
    factor = damping.stiffness_factor if isinstance(damping, RayleighDamping) else 0.0
    return np.asarray(factor)[..., None]
