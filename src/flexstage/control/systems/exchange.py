"""Conversion of systems to and from python-control (the extra `control`)."""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel


@check_arguments
def to_control(system: System, states: tuple[str, ...] | None = None) -> Any:
    """Convert a system to `control.StateSpace`. Names of inputs and outputs are kept, with dots replaced by underscores (`error_x`).

    `states` are names for the system's states, for instance `Loop.states`. A continuous system has dt = 0. Raises `DesignError` without
    python-control, and for names that differ only in dots and underscores.

    >>> from flexstage.control.example import integral_loop
    >>> found = to_control(integral_loop().controller)
    >>> found.input_labels, found.output_labels, found.dt
    (['error_x'], ['command_B'], 0.0001)
    """
    control = _control()
    names = [[name.replace(".", "_") for name in group] for group in (system.input_names, system.output_names, states or ())]
    for group in names:
        require(
            Finding(name, f"{group.count(name)} names become equal", "Rename all but one")
            for name in dict.fromkeys(group)
            if group.count(name) > 1
        )
    step = 0 if system.step is None else system.step
    matrices = (system.A, system.B, system.C, system.D)
    return control.ss(*matrices, step, inputs=names[0], outputs=names[1], **({"states": names[2]} if states else {}))


@check_arguments
def from_control(system: Any, inputs: tuple[Channel, ...] | None = None, outputs: tuple[Channel, ...] | None = None) -> System:
    """Convert a `control.StateSpace`, or a single-input single-output transfer function, to a system.

    `inputs` and `outputs` are the channels with names and units (default: the system's own labels, without units). The channels of a
    controller are for example `error.x` and `command.B1`. Raises `DesignError` for a sampled system without a time step, for an object that
    is not a linear system, and for a wrong number of channels.

    >>> from flexstage.control.example import integral_loop
    >>> one = integral_loop().controller
    >>> there = from_control(to_control(one), one.inputs, one.outputs)
    >>> bool(np.array_equal(there.A, one.A)), there.input_names, there.step
    (True, ('error.x',), 0.0001)
    """
    control = _control()
    if not isinstance(system, control.StateSpace | control.TransferFunction):
        raise refuse(
            "system",
            f"wrong type (got {type(system).__name__}, expected StateSpace or TransferFunction)",
            "Linearise or convert the system",
        )
    if isinstance(system, control.TransferFunction) and (system.ninputs, system.noutputs) != (1, 1):
        what = f"unsupported transfer function with {system.ninputs} inputs and {system.noutputs} outputs"
        raise refuse(
            "system", what, "Convert the system to a StateSpace: a transfer function with several channels has no unique realisation"
        )
    found = control.ss(system)
    if found.dt is True or found.dt is None:
        raise refuse(
            "system", f"no sampling time (got dt = {found.dt}, expected a number)", "Specify dt in seconds, or 0 for a continuous system"
        )
    channels = [_channels(given, found, kind) for given, kind in ((inputs, "input"), (outputs, "output"))]
    matrices = (np.array(matrix, dtype=float) for matrix in (found.A, found.B, found.C, found.D))
    return System(*matrices, inputs=channels[0], outputs=channels[1], step=float(found.dt) or None)


def _control() -> Any:
    try:
        return importlib.import_module("control")
    except ImportError:
        raise refuse("python-control", "not installed", "Install python-control: pip install 'flexstage[control]'") from None


def _channels(given: tuple[Channel, ...] | None, system: Any, kind: str) -> tuple[Channel, ...]:
    labels = getattr(system, f"{kind}_labels")
    if given is None:
        return tuple(Channel(label, "1") for label in labels)
    if len(given) != len(labels):
        what = f"wrong number of names (got {len(given)}, expected {len(labels)})"
        raise refuse(f"{kind}s", what, f"Use one channel for each {kind}")
    return given
