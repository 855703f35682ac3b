"""Random linear models for the laws of responses: dense, well conditioned, with bodies, a stroke, a gauge and some massless freedoms."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from flexstage.mechanism.mechanism import ModalDamping, RayleighDamping, StructuralDamping
from flexstage.models.linear.model import Channel, Contribution, LinearModel
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, transport

BODIES = ("platform", "arm")
SIZE = 6 * len(BODIES)


def _positive(random, size, rank=None):
    factor = random.normal(size=(size, rank or 2 * size))
    return factor @ factor.T / (rank or 2 * size)


def linear_model(seed, batch=(), massless=False, damping=None):
    """Two bodies on the ground and on one another; `B1` is a stroke in the part between them, `S1` a gauge on it."""
    random = np.random.default_rng(seed)
    arm = random.normal(size=3)
    rigid = np.concatenate([np.eye(6), transport(arm)])
    select = np.eye(SIZE)
    between = select[:6] @ np.eye(SIZE) - np.linalg.inv(transport(arm)) @ select[6:]
    scale = 1.0 + random.uniform(size=(*batch, 1, 1))
    parts = {
        "foot": Contribution(select[:6], 40.0 * scale * (_positive(random, 6) + np.eye(6)), random.uniform(0.001, 0.1)),
        "side": Contribution(select[6:], 90.0 * scale * (_positive(random, 6) + np.eye(6)), random.uniform(0.001, 0.1)),
        "pzt": Contribution(between, 70.0 * (_positive(random, 6) + 0.3 * np.eye(6)), random.uniform(0.001, 0.1)),
    }
    inertia = {"platform": Contribution(select[:6], _positive(random, 6) + 0.3 * np.eye(6))}
    inertia["arm"] = Contribution(select[6:], _positive(random, 6, 3 if massless else None))
    outputs = tuple(Channel(f"{body}.{part}", unit) for body in BODIES for part, unit in zip(COMPONENTS, TWIST_UNITS, strict=True))
    force = np.concatenate([np.zeros((SIZE, 1)), select[:, :6]], axis=1)
    imposed = np.zeros((6, 7))
    imposed[0, 0] = 1.0
    strain = parts["pzt"]
    own = -(strain.law @ imposed)[:1]
    output = np.concatenate([select, between[:1], strain.law[:1] @ between])
    mass = sum(item.operator.T @ item.law @ item.operator for item in inertia.values())
    return LinearModel(
        coordinates=tuple(channel.name for channel in outputs),
        stiffness=parts,
        inertia=inertia,
        inputs=(Channel("B1", "m"), *(Channel(f"platform.{name}", "N" if name[0] == "f" else "N m") for name in FORCES)),
        force=force,
        imposed={"pzt": imposed},
        outputs=(*outputs, Channel("S1", "m"), Channel("pzt.fx", "N")),
        output=output,
        feedthrough=np.concatenate([np.zeros((SIZE + 1, 7)), own]),
        rigid=rigid,
        rigid_output=np.concatenate([rigid, np.zeros((2, 6))]),
        base_inertia=mass @ rigid,
        damping=damping,
        idle=(),
        provenance="random",
    )


seeds = st.integers(0, 2**32 - 1)
"""Dense random matrices are drawn by seed: their entries have no structure that could be shrunk to something simpler."""

models = st.builds(linear_model, seeds, massless=st.booleans())
ratios = st.floats(1e-4, 0.3)
laws = st.one_of(
    st.builds(ModalDamping, ratios),
    st.just(StructuralDamping()),
    st.builds(RayleighDamping, st.floats(0.0, 1.0), st.floats(1e-5, 1e-2)),
)
