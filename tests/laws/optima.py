"""Small stages whose optima are known."""

from __future__ import annotations

from flexstage.mechanism.store import loads
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.sweeps.file import loads_study

STEEL = """
[materials.steel]
young = "200 GPa"
poisson = 0.3
density = "7750 kg/m^3"
yield_stress = "1000 MPa"
"""

POST = f"""
format = "flexstage 1"
name = "cube on a post"
{STEEL}
[parts.post]
kind = "neck"
material = "steel"
thickness = "5 mm"
width = "2 mm"
profile = {{ shape = "straight", length = "30 mm" }}
[bodies.platform.solids.cube]
shape = "block"
material = "steel"
size = ["50 mm", "50 mm", "50 mm"]
at = ["0 mm", "0 mm", "0 mm"]
[links]
post = {{ joins = ["ground", "platform"], part = "post", at = ["0 mm", "0 mm", "-40 mm"], along = "z", bends = "y" }}
"""

TRIPOD = f"""
format = "flexstage 1"
name = "disc on three blades"
{STEEL}
[parts.blade]
kind = "leaf"
material = "steel"
length = "30 mm"
thickness = "1 mm"
width = "12 mm"
[bodies.platform.solids.disc]
shape = "cylinder"
material = "steel"
diameter = "120 mm"
length = "10 mm"
at = ["0 mm", "0 mm", "5 mm"]
[units.post.links]
blade = {{ joins = ["ground", "platform"], part = "blade", at = ["0 mm", "0 mm", "-15 mm"], along = "z", bends = "y" }}
[placements.P1-P3]
unit = "post"
polar = {{ radius = "50 mm", first = "0 deg", facing = "outward", height = "0 mm" }}
[overrides]
"P1/blade.thickness" = "0.7 mm"
"P2/blade.thickness" = "0.9 mm"
"P3/blade.thickness" = "1.4 mm"
"""

BLADES = """
[variables]
a = { address = "P1/blade.thickness", from = "0.5 mm", to = "2 mm" }
b = { address = "P2/blade.thickness", from = "0.5 mm", to = "2 mm" }
c = { address = "P3/blade.thickness", from = "0.5 mm", to = "2 mm" }
[responses]
f1 = "frequency.platform.1"
"""


def post_variables(step=""):
    """Thickness and width of the post; `step` is added to both."""
    return f"""
[variables]
t = {{ address = "parts.post.thickness", from = "1 mm", to = "8 mm"{step} }}
w = {{ address = "parts.post.width", from = "1 mm", to = "8 mm", logarithmic = true{step} }}
[responses]
f1 = "frequency.platform.1"
k = "stiffness.z"
"""


def study_of(folder, design, text):
    """A study of a design given as text, and what is wanted."""
    loads(design)
    (folder / "stage.toml").write_text(design)
    study = loads_study(f'format = "flexstage study 1"\ndesign = "stage.toml"\n{text}', folder=folder)
    return study, load_optimisation(study)


def case_of(case, text):
    """A study of a shipped case, and what is wanted."""
    study = loads_study(f'format = "flexstage study 1"\ncase = "{case}"\n{text}')
    return study, load_optimisation(study)
