"""Stages that others built or computed: the numbers they print, and ours."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

import flexstage as fs
from flexstage.cases.registry import case
from flexstage.models.linear.static import static_gain
from flexstage.parts.body import Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.studies.synthesis.specification import loads_specification
from tests.analytic.test_inner_modes import stage as clamped_free
from tools.validation import displaced
from tools.validation.row import Row, Scale, Section, Tolerance, relative

_SU = "Su, solid elements"
_UNIT = 210e9 * 0.05 * 0.005**3 / 12.0 / 0.25**2
"""E I / L^2 of the source's leaves [N]."""


def sections() -> list[Section]:
    """A section for each source."""
    return [_telescope(), _mirror(), _guide(), _resonator(), _suspension(), _leaf(), *displaced.sections(), _specification()]


def _motion(model: fs.LinearModel, output: str, load: str) -> float:
    return float(static_gain(model, (f"platform.{output}",), (f"platform.{load}",)).values[0, 0])


def _near(model: fs.LinearModel, printed: str) -> float:
    """The natural frequency next to the printed one [Hz]."""
    found = fs.modes(model).frequencies
    return float(found[np.argmin(np.abs(found - float(printed)))])


def _telescope() -> Section:
    printed = ("172.4707", "172.4707", "233.9532", "281.3463", "281.7757", "281.7757")
    found = fs.modes(fs.lumped(case("telescope-mount"))).frequencies
    thinner = fs.modes(fs.lumped(case("telescope-mount", {"thickness": "2 mm"}))).frequencies[0]
    rows = [
        Row(f"frequency {number + 1}", "assembly_sim1-modal.f06", each, float(found[number]), "Hz", relative(5e-4))
        for number, each in enumerate(printed)
    ]
    rows.append(Row("frequency 1, blades of 2 mm", "Iterations.txt", "165", float(thinner), "Hz"))
    text = (
        "`telescope-mount`: GitHub GardenerGeralt/ssd-2024-group-b at f1b61c4b (MIT), beam elements with lumped masses, which have no "
        "rotary inertia: that of the struts' sections is 0.04 %."
    )
    return Section("A telescope on bipods", text, tuple(rows), repeat="flexstage new t.toml --case telescope-mount; flexstage modes t.toml")


def _mirror() -> Section:
    model = fs.lumped(case("mirror-mount"))
    sag, first = 46.0 * 9.80665e6 * _motion(model, "x", "fx"), float(fs.modes(model).frequencies[0])
    rows = (
        Row("sag sideways", "their Eqs. 2 to 20", "10.5", sag, "um", relative(0.01)),
        Row("sag sideways", "their finite elements", "11.2", sag, "um", relative(0.01), recorded=True),
        Row("frequency 1", "their Eqs. 2 to 20", "148.1", first, "Hz", relative(0.01), recorded=True),
    )
    text = (
        "`mirror-mount`: Kihm, Yang & Lee, Rev. Sci. Instrum. 85, 125101 (2014), Tables I to III. They print no modulus: ours is that "
        "of Invar in handbooks, and no inertia of the mirror."
    )
    return Section("A mirror on bipods", text, rows, repeat="flexstage new m.toml --case mirror-mount; flexstage modes m.toml")


def _guide() -> Section:
    stage = case("leaf-guide")
    model, far = fs.lumped(stage), fs.equilibrium(fs.nonlinear(stage), {"platform.fy": 5.0 * _UNIT}, weight=0.0)
    turn = 0.25 * _UNIT * _motion(model, "rz", "mz")
    rows = (
        Row("y under 0.5 E I/L^2", _SU, "5.01558", 5e2 * _UNIT * _motion(model, "y", "fy"), "mm", relative(6e-3)),
        Row("rz under E I/L", _SU, "1.837729e-4", turn, "rad", relative(0.017)),
        Row("x under E I/L^2", _SU, "4.29476e-3", 1e3 * _UNIT * _motion(model, "x", "fx"), "mm", relative(0.011), recorded=True),
        Row("y under 5 E I/L^2, nonlinear", f"{_SU} of 3 mm", "48.6102", 1e3 * float(far.displacement()[1]), "mm", relative(2e-3)),
        Row("x under 5 E I/L^2, nonlinear", f"{_SU} of 3 mm", "-5.7723", 1e3 * float(far.displacement()[0]), "mm", relative(3e-3)),
        Row("rz under 5 E I/L^2, nonlinear", f"{_SU} of 3 mm", "1.277e-3", float(far.rotation()[2]), "rad", relative(5e-3), recorded=True),
    )
    text = (
        "`leaf-guide`: GitHub haijunsu-osu/parallelogram_model_comparison at 20457f69, fea_models/3d (numbers only, there is no "
        "licence): PARALLOGRAM_FEA_3D_sweep.csv by elements of 10 mm, whose errors MESH_REFINEMENT_COMPARISON.md gives as 0.6 % in y, "
        "1.05 % in x and 1.7 % in rz; its last row, elements of 3 mm, still moves by about twice 0.1 %. A leaf as a beam gives 4.1 % "
        "more in y."
    )
    return Section("A guide of wide leaves", text, rows, repeat="flexstage new g.toml --case leaf-guide; flexstage modes g.toml")


def _resonator() -> Section:
    plate, legs = 250.0 * 120.0, 4.0 * 200.0 * 2.0
    lighter = (1.0 + 13.0 / 35.0 * legs / plate) ** -0.5 - 1.0
    found = 1e-3 * float(fs.modes(fs.lumped(case("resonator"))).frequencies[0])
    source = "COMSOL 477, its formula"
    rows = (
        Row("frequency", source, "14.989", found, "kHz", Tolerance(1e-3, Scale.RELATIVE, lighter)),
        Row("frequency under a stress of 50 MPa", source, "33.081", found, "kHz", relative(1e-3), recorded=True),
    )
    text = (
        "`resonator`: residual_stress_resonator_2d_parameters.txt of COMSOL application 477. It prints dimensions and formulas; the "
        "references are what these give. They leave out the mass of the legs, of which 13/35 move with the plate."
    )
    return Section("A resonator on four legs", text, rows, repeat="flexstage new r.toml --case resonator; flexstage modes r.toml")


def _suspension() -> Section:
    model = fs.lumped(case("quad-suspension"))
    rows = tuple(
        Row(f"vertical mode {number + 1}", "derived", printed, _near(model, printed), "Hz")
        for number, printed in enumerate(("0.5959", "2.3654", "3.8079", "9.7320"))
    )
    text = (
        "`quad-suspension`: masses, blades and fibres of GitHub ark0015/pygwinc_clone (Unlicense), gwinc/ifo/aLIGO/ifo.yaml; the "
        "frequencies follow from them by a chain of four masses, written out in tests/elsewhere/test_published_stages.py. The file "
        "prints none."
    )
    return Section("A suspension of four masses", text, rows, repeat="flexstage new q.toml --case quad-suspension; flexstage modes q.toml")


def _leaf() -> Section:
    silicon = Material(young=169e9, poisson=0.066, density=2329.0)
    blade = Leaf("steel", 100e-6, 2e-6, 20e-6, inner_modes=4)
    tip = replace(clamped_free(blade, Body(reference=(0.0, 0.0, -50e-6))), materials={"steel": silicon})
    model = fs.lumped(tip)
    printed = (("bending 1", "275.44", 0.003, False), ("bending 2", "1733.7", 0.01, False), ("in its plane", "2684.3", 0.01, False))
    twists = (("twist 1", "3011.6", 0.02, True), ("twist 2", "9206.6", 0.02, True))
    rows = tuple(
        Row(what, "cbeam.vhd", each, 1e-3 * _near(model, str(1e3 * float(each))), "kHz", relative(allowed), recorded=recorded)
        for what, each, allowed, recorded in (*printed, *twists)
    )
    text = (
        "No case, but a part: a leaf of silicon, 100 x 20 x 2 um, clamped and free, by ANSYS; GitHub "
        "Kolchuzhin/LMGT_MEMS_component_library at 958be495 (MIT), clamped_beam. The tip of ours is a rigid body without mass, which "
        "cannot warp."
    )
    return Section("A wide leaf", text, rows, repeat=".venv/bin/python -m pytest tests/analytic/test_inner_modes.py -k component_library")


def _specification() -> Section:
    """The strokes that the paper requires, and those of the stages found by `flexstage design` for the tutorial's specification."""
    text = Path(__file__).parents[2].joinpath("docs", "tutorials", "specification.md").read_text(encoding="utf-8")
    specification = loads_specification(text.partition("```toml file=spec.toml\n")[2].partition("```")[0])
    rows = tuple(
        Row(
            f"{answer.architecture}: stroke over required stroke, smallest",
            "paper, required",
            "1",
            math.floor(100.0 * least) / 100.0,
            least=True,
        )
        for answer in fs.design(specification).answers
        for least in (min(answer.values[f"stroke.{axis}"] / value for axis, value in specification.displacements.items()),)
    )
    about = (
        "Stages found by `flexstage design` for the required strokes and the box of Shin & Moon, with the specification of the "
        "[tutorial](../tutorials/specification.md), where payload and opening are assumed. The ratios are rounded down. The paper gives no "
        "frequency to compare: the tutorial compares them with the case `double-triangle`."
    )
    return Section("Stages found for the paper's strokes", about, rows, repeat="flexstage design spec.toml -o answers")
