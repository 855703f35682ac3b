"""What the trade calls things, and what they are called here: for advice where a word of a file is not known."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from flexstage.base.finding import suggest_nearest
from flexstage.base.renamed import new_name

_NOTCH = 'with profile = { shape = "circular", radius = "5 mm" }, or another shape'
_KINDS: Mapping[str, tuple[str, ...]] = {
    "cross_hinge": (
        "cross",
        "crossed",
        "crosspivot",
        "crossspring",
        "crossspringpivot",
        "crossedleaf",
        "crossedleaves",
        "crossedflexure",
        "crossflexure",
        "xhinge",
    ),
    "cartwheel": ("cartwheelhinge", "cartwheelflexure", "wheel"),
    "folded_leaf": ("folded", "foldedleafspring", "foldedflexure", "foldedblade"),
    "leaf": ("leafspring", "flexure", "flexurehinge", "blade", "bladeflexure", "reed", "sheet", "strip", "platespring", "beam"),
    "notch": (
        "notchhinge",
        "hinge",
        "circular",
        "circularhinge",
        "rightcircular",
        "circularnotch",
        "elliptic",
        "elliptichinge",
        "filleted",
        "cornerfilleted",
        "livinghinge",
    ),
    "neck": ("toroid", "toroidal", "toroidalhinge", "universal", "universaljoint", "cardan", "ball", "balljoint", "spherical"),
    "rod": ("wire", "wireflexure", "needle", "pin", "pinflexure", "strut"),
    "piezo": ("stack", "pzt", "piezostack", "piezoactuator", "piezoelectric", "stackactuator", "apa", "actuator"),
    "voice_coil": (
        "voicecoil",
        "vcm",
        "vca",
        "voicecoilmotor",
        "voicecoilactuator",
        "lorentz",
        "lorentzactuator",
        "movingcoil",
        "linearmotor",
        "coil",
    ),
    "force_actuator": ("force", "forcer", "motor"),
    "spring": ("coilspring", "helicalspring", "preloadspring", "springdamper", "bellows", "bushing"),
    "contact": ("hertz", "hertzian", "hertzcontact", "ballcontact", "vgroove", "kinematiccoupling", "kinematicmount", "maxwell"),
    "compliance_matrix": ("compliance", "matrix", "stiffnessmatrix", "fea", "measured"),
    "superelement": ("substructure", "craigbampton", "reduced", "condensed"),
    "joint": ("ideal", "idealjoint", "revolute", "prismatic", "bearing"),
    "gauge": ("capacitive", "capacitance", "capacitor", "capacitivesensor", "sensor", "probe"),
    "interferometer": ("laser", "laserinterferometer"),
    "encoder": ("linearencoder", "scale", "grating"),
    "strain_gauge": ("straingauge", "straingage", "sgs"),
    "accelerometer": ("acceleration", "accel"),
    "circular": ("circle", "round", "rightcircular"),
    "elliptic": ("ellipse", "elliptical"),
    "filleted": ("fillet", "cornerfilleted"),
    "straight": ("prismatic", "rectangular"),
    "block": ("box", "cuboid", "plate", "rectangle"),
    "cylinder": ("disc", "disk", "tube", "pipe", "ring", "round"),
    "step": ("stp", "cad", "imported", "import", "file"),
    "modal": ("ratio", "viscous", "damping_ratio"),
    "structural": ("hysteretic", "lossfactor"),
    "rayleigh": ("proportional",),
}
"""What a kind or shape is called elsewhere, in small letters without signs between words."""
_REMARKS: Mapping[str, str] = {"notch": _NOTCH, "neck": _NOTCH}
_KEYS: Mapping[str, tuple[str, ...]] = {
    "young": ("E", "modulus", "youngs_modulus", "young_modulus", "elastic_modulus"),
    "poisson": ("nu", "v", "poisson_ratio", "poissons_ratio"),
    "density": ("rho",),
    "expansion": ("alpha", "cte", "thermal_expansion"),
    "yield_stress": ("sigma_y", "yield", "yield_strength", "Re", "Rp02"),
    "loss_factor": ("eta", "tan_delta", "damping"),
    "thickness": ("t", "h", "thick"),
    "length": ("L", "l"),
    "width": ("b", "w", "depth"),
    "radius": ("r", "R"),
    "diameter": ("d", "D", "dia"),
    "stiffness": ("k", "K", "k_a"),
    "compliance": ("C", "matrix"),
    "capacitance": ("C",),
    "mass": ("m", "M", "weight"),
    "inertia": ("I", "J", "moments"),
    "centre": ("center", "com", "cog", "centre_of_mass"),
    "stroke": ("free_stroke", "travel", "displacement"),
    "maximum_load": ("blocking_force", "max_load"),
    "material": ("mat",),
    "kind": ("type",),
    "shape": ("type", "kind"),
    "profile": ("shape", "contour"),
    "size": ("dimensions", "dims", "edges"),
    "at": ("position", "pos", "origin", "location", "xyz"),
    "along": ("direction", "dir", "axis", "x_axis"),
    "bends": ("bending_axis", "hinge_axis", "rotation_axis", "normal", "z_axis"),
    "joins": ("bodies", "between", "connects", "nodes", "ends"),
    "part": ("hinge", "element"),
    "free": ("dof", "dofs", "freedoms", "releases"),
    "ratio": ("zeta", "damping_ratio", "xi"),
    "first": ("angle", "start", "phase"),
    "facing": ("orientation",),
    "numbers": ("variables", "parameters", "params", "constants", "define"),
    "parts": ("hinges", "elements", "flexures"),
    "links": ("joints", "connections"),
    "bodies": ("masses", "rigid_bodies"),
    "units": ("assemblies", "limbs", "legs"),
    "requirements": ("specification", "spec", "limits"),
    "overrides": ("changes", "departures"),
    "noise_density": ("noise",),
    "include": ("import", "imports", "includes"),
}
"""What a key is called elsewhere, as it is written there: symbols are told by their case."""


def advise_kind(word: str, known: Collection[str]) -> str:
    """Advice about the word of a kind or shape that is not known: what the trade means by it, else what is near to it.

    >>> advise_kind("Leaf-Spring", ["leaf", "notch"]), advise_kind("leef", ["leaf", "notch"])
    ('It is called leaf here', 'The nearest name is leaf')
    """
    plain = re.sub(r"[\s_-]", "", word.strip('"').lower())
    meant = [kind for kind, words in _KINDS.items() if kind in known and plain in words]
    if not meant:
        return suggest_nearest(word.strip('"'), known)
    told = " or ".join(f"{kind} ({_REMARKS[kind]})" if kind in _REMARKS else kind for kind in meant)
    return f"It is called {told} here"


def advise_key(key: str, unused: Collection[str], known: Collection[str]) -> str:
    """Advice about a key that is not known: what its symbol stands for, else what is near to it, first of those not yet used.

    >>> advise_key("E", {"young", "density"}, {"young", "density"}), advise_key("thicknes", {"section"}, {"section", "thickness"})
    ('It is called young here', 'The nearest name is thickness')
    """
    meant = [name for name in known if key in _KEYS.get(name, ()) or name == new_name(key, known)]
    if meant:
        return f"It is called {' or '.join(meant)} here"
    advice = [suggest_nearest(key, names) for names in (unused, known) if names]
    return next((each for each in advice if not each.startswith("There ")), advice[0] if advice else "There are none")
