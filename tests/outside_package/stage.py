"""The shipped parallelogram, with the tapered leaf, the interferometer and a line about the sag; it names the package they come from."""

from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.store import dumps

LEAF = """kind = "leaf"
material = "aluminium"
length = "25 mm"
thickness = "1 mm"
"""
TAPER = """kind = "taper"
material = "aluminium"
length = "25 mm"
thickness = "0.9 mm"
end_thickness = "1.2 mm"
"""
INTERFEROMETER = """[sensors.probe]
kind = "interferometer"
travel = "200 um"
fringe = "20 nm"
steps = 1000
bandwidth = "3000 Hz"
"""
LINE = '"stroke.x" = "at least 18 um"\n'
SMALL = """format = "flexstage 1"
name = "block on two tapered leaves"
[materials.aluminium]
like = "7075-T6"
[parts.leaf]
kind = "taper"
material = "aluminium"
length = "25 mm"
thickness = "2 mm"
end_thickness = "3 mm"
width = "10 mm"
[bodies.platform]
solids = { block = { shape = "block", material = "aluminium", size = ["60 mm", "30 mm", "10 mm"] } }
[links]
left = { joins = ["ground", "platform"], part = "leaf", at = ["-25 mm", "27.5 mm", "0 mm"], along = "-y", bends = "z" }
right = { joins = ["ground", "platform"], part = "leaf", at = ["25 mm", "27.5 mm", "0 mm"], along = "-y", bends = "z" }
"""
"""A block on two tapered leaves: a small solid."""


def design():
    """Its design file."""
    text = dumps(parallelogram()).replace('name = "parallelogram"\n', 'name = "parallelogram"\npackages = ["tapered-leaf >= 1"]\n')
    before, _, after = text.partition("[sensors.probe]\n")
    assert LEAF in before
    assert LINE in after
    after = after[after.index("\n\n") :].replace(LINE, f'{LINE}sag = "at most 0.1 mm"\n')
    return before.replace(LEAF, TAPER) + INTERFEROMETER + after
