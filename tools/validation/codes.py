"""Independent codes: the same stage assembled, linearised and solved in Exudyn, where it is installed."""

from __future__ import annotations

import importlib.util
from importlib.metadata import version

import numpy as np

import flexstage as fs
from flexstage.mechanism.assembly.expand import expand
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS
from tools.validation import displaced
from tools.validation.row import Row, Section, relative, table

_TITLE = "Exudyn"


def sections() -> list[Section]:
    """The sections on other codes."""
    if importlib.util.find_spec("exudyn") is None:
        absent = Section(_TITLE, "Exudyn is not installed here (it has no wheels for this interpreter): nothing was compared.")
        return [absent, *displaced.codes()]
    return [_frequencies(), _gains(), *displaced.codes()]


def _frequencies() -> Section:
    from tests.elsewhere.exudyn_model import frequencies, matrices, system
    from tests.elsewhere.test_exudyn import FREE, STAGES

    rows: list[Row] = []
    lines: list[tuple[str, ...]] = []
    for name, build in STAGES.items():
        stage = build()
        model, peer = fs.lumped(stage), system(stage, expand(stage))
        theirs, ours = frequencies(peer), fs.modes(model).frequencies
        worst = int(np.argmax(np.abs(ours / theirs - 1.0)))
        label = f"{name}: frequency {worst + 1} of {len(theirs)}, the worst"
        rows.append(Row(label, "Exudyn", f"{theirs[worst]:.13g}", float(ours[worst]), "Hz", relative(1e-8)))
        shown = " ".join(f"{value:.4f}" for value in theirs[:6])
        entries = "not compared: locked freedoms are eliminated here"
        if name in FREE:
            pairs = zip(matrices(peer), (model.inertia_matrix, model.stiffness_matrix), strict=True)
            entries = f"{max(_entries(*pair) for pair in pairs):.0e}"
        lines.append((name, str(len(theirs)), shown, entries))
    text = (
        f"Version {version('exudyn')} (J. Gerstmayr, University of Innsbruck). Shared are the expansion of the description and the 6x6 "
        "of single parts; kinematics, assembly, linearisation and eigenvalues are Exudyn's own. All frequencies are compared; listed "
        "is the worst."
    )
    heads = ("stage", "modes", "the lowest six by Exudyn [Hz]", "entries of M and K, largest scaled difference")
    return Section(f"{_TITLE}: frequencies and matrices", text, tuple(rows), (table(heads, lines),))


def _entries(theirs: np.ndarray, ours: np.ndarray) -> float:
    scale = np.sqrt(np.diag(ours))
    return float(np.max(np.abs(ours - theirs) / scale / scale[:, None]))


def _gains() -> Section:
    from tests.elsewhere.exudyn_model import stroked, system
    from tests.elsewhere.test_exudyn import STAGES

    stage = STAGES["double-triangle"]()
    model, peer = fs.lumped(stage), system(stage, expand(stage))
    rows: list[Row] = []
    for actuator, component in (("B1", 0), ("B4", 2)):
        names = tuple(f"platform.{name}" for name in COMPONENTS)
        ours = static_gain(model, names, (actuator,)).values[component, 0]
        forth, back = (stroked(peer, f"{actuator}/pzt", stroke)[component] for stroke in (1e-4, -1e-4))
        value = f"{(forth - back) / 2e-4:.9g}"
        rows.append(Row(f"platform.{COMPONENTS[component]} per stroke of {actuator}", "Exudyn", value, float(ours), "1", relative(1e-6)))
    text = "Slope of Exudyn's *nonlinear* equilibrium over strokes of 0.1 mm both ways; its cubic term is of the size of the difference."
    return Section(f"{_TITLE}: static gain", text, tuple(rows))
