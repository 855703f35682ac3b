"""Imported solids: outlines from STEP files, compared with the values of the description."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from netgen import occ

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, Number, stack
from flexstage.base.storage.files import require_regular
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.body import Body, Imported, Inertia
from flexstage.parts.mass import tensor
from flexstage.solid.fea.geometry.piece import MILLIMETRES, coordinates

_DIGITS = 6
"""Decimals of a box's side lengths [mm]: the kernel widens boxes by 1e-7 mm."""
TOLERANCE = 1e-3
"""Largest permitted difference between specified values and the file, divided by the mass, the inertia, or the longest side (positions)."""


@dataclass(frozen=True, eq=False)
class ImportedProperties:
    """Properties of a solid in its file's axes: `size` (side lengths) and `middle` of the bounding box [m], volume [m^3], centroid [m].

    `inertia` (3, 3) [m^5] is the inertia tensor about the centroid for unit density. `sha256` is the digest of the file.
    """

    sha256: str
    size: Array
    middle: Array
    volume: float
    centre: Array
    inertia: Array


def imported_shape(form: Imported) -> occ.TopoDS_Shape:
    """Return the file's solid [mm], with the middle of its bounding box at the origin.

    Raises `DesignError` if the file is missing, is not a STEP file, has another digest, or does not contain exactly one matching solid.
    """
    path = Path(form.file)
    require(_version_findings(path, form.sha256))
    x, y, z = (-MILLIMETRES * float(np.real(value)) for value in form.middle)
    own = _solid(path, form.solid)
    return (own.Mirror(_ACROSS) if form.reflected else own).Move(occ.Vec(x, y, z))


_ACROSS = occ.Axes(occ.Pnt(0, 0, 0), n=occ.Y, h=occ.X)
"""The x-z plane, for mirror images."""


def measure(path: Path, name: str | None = None) -> ImportedProperties:
    """Measure a solid in a STEP file: the only one, or the solid with this `name` or number (`#2`).

    Raises `DesignError` if the file is missing, or does not contain exactly one matching solid.

    >>> measure(Path("nowhere.step"))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: nowhere.step: file not found. Check the path.
    """
    digest = _sha256(path)
    solid = _solid(path, name)
    low, high = (np.round(coordinates(corner), _DIGITS) / MILLIMETRES for corner in solid.bounding_box)
    volume = float(solid.mass) / MILLIMETRES**3
    centre = coordinates(solid.center) / MILLIMETRES
    return ImportedProperties(digest, high - low, 0.5 * (low + high), volume, centre, _inertia(solid))


def _inertia(solid: occ.TopoDS_Shape) -> Array:
    """The inertia tensor of unit density about the centre [m^5]."""
    matrix = solid.inertia
    return np.array([[matrix[i, j] for j in range(3)] for i in range(3)]) / MILLIMETRES**5


def with_properties(found: ImportedProperties, file: str, material: str, density: float, solid: str | None = None) -> Imported:
    """Describe a measured solid of this `density` [kg/m^3]. If the file contains several solids, `solid` is the name of the measured solid.

    >>> cube = ImportedProperties("", np.ones(3), np.zeros(3), 1.0, np.zeros(3), np.eye(3) / 6.0)
    >>> round(with_properties(cube, "cube.step", "steel", 6.0).inertia.zz, 12)
    1.0
    """
    j = density * found.inertia
    inertia = Inertia(*(float(j[i, i]) for i in range(3)), xy=-float(j[0, 1]), xz=-float(j[0, 2]), yz=-float(j[1, 2]))
    return Imported(
        material=material,
        file=file,
        sha256=found.sha256,
        size=_triple(found.size),
        mass=density * found.volume,
        centre=_triple(found.centre),
        inertia=inertia,
        middle=_triple(found.middle),
        solid=solid,
    )


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z


def import_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return the differences between imported solids and their description; empty if they agree.

    >>> import_findings(Mechanism("nothing"))
    ()
    """
    return tuple(finding for where, solid in _imported_bodies(mechanism) for finding in _findings(mechanism, where, solid))


def _imported_bodies(mechanism: Mechanism) -> Iterator[tuple[str, Imported]]:
    sections: dict[str, Mapping[str, Body]] = {"bodies": mechanism.bodies}
    sections |= {f"units.{name}.bodies": unit.bodies for name, unit in mechanism.units.items()}
    for section, bodies in sections.items():
        for name, body in bodies.items():
            for solid, each in body.solids.items():
                if isinstance(each, Imported):
                    yield f"{section}.{name}.solids.{solid}", each


def _findings(mechanism: Mechanism, where: str, solid: Imported) -> Iterator[Finding]:
    path = Path(solid.file)
    solid = solid.mirrored if solid.reflected else solid
    try:
        found = measure(path, solid.solid)
    except DesignError as error:
        yield from (Finding(f"{where}.file", f"{each.where}: {each.what}", each.advice) for each in error.findings)
        return
    if found.sha256 != solid.sha256:
        yield from (Finding(f"{where}.sha256", each.what, each.advice) for each in _version_findings(path, solid.sha256))
        return
    density, longest = float(np.real(mechanism.materials[solid.material].density)), float(np.max(found.size))
    measured, moment = with_properties(found, solid.file, solid.material, density), float(np.max(np.linalg.eigvalsh(found.inertia)))
    scales = {"size": longest, "middle": longest, "mass": measured.mass, "centre": longest, "inertia": density * moment}
    for name, scale in scales.items():
        said, true = (_values(getattr(each, name)) for each in (solid, measured))
        unit = {"mass": "kg", "inertia": "kg m^2"}.get(name, "m")
        off = float(np.max(np.abs(np.real(said) - true)))
        if off > TOLERANCE * scale:
            what = f"differs from the file by {off:.4g} {unit} (got {_text(said)}, expected {_text(true)} {unit})"
            yield Finding(f"{where}.{name}", what, 'Use the value of the file (see "flexstage import")')


def _values(value: Number | tuple[Number, ...] | Inertia) -> Array:
    return tensor(value) if isinstance(value, Inertia) else stack(value) if isinstance(value, tuple) else np.asarray(value)


def _text(values: Array) -> str:
    numbers = ", ".join(f"{float(value):.5g}" for value in np.ravel(np.real(values)))
    return numbers if np.size(values) == 1 else f"({numbers})"


def _version_findings(path: Path, sha256: str) -> Iterator[Finding]:
    found = _sha256(path)
    if found != sha256:
        what = f"the content of the file has changed (got sha256 {found[:12]}..., expected {sha256[:12]}...)"
        yield Finding(str(path), what, 'Restore the file, or import the new one (see "flexstage import")')


def _sha256(path: Path) -> str:
    require_regular(path)
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise refuse(str(path), f"it cannot be read: {reason}", "Use an absolute path, or a path relative to the design file") from None


def _solid(path: Path, name: str | None) -> occ.TopoDS_Shape:
    with path.open("rb") as stream:
        start = stream.read(200)
    if not start.lstrip().startswith(b"ISO-10303-21"):
        raise refuse(str(path), "not a STEP file (it does not begin with ISO-10303-21)", "Export the solid as STEP")
    if path.suffix.lower() not in {".step", ".stp"}:
        raise refuse(str(path), f'its name ends in "{path.suffix}" (expected .step or .stp)', "Rename the file")
    try:
        solids = list(occ.OCCGeometry(str(path)).shape.solids)
    except Exception as error:  # noqa: BLE001 (the CAD kernel raises what it likes)
        raise refuse(str(path), f"the CAD kernel cannot read it ({error})", "Export the solid as STEP (AP214) again") from None
    names = _names(path, solids)
    if name is None and len(solids) != 1:
        what = f"it contains {len(solids)} solids: {', '.join(names)}"
        raise refuse(str(path), what, f'Select one: solid = "{next(iter(names), "")}"; a body may have several solids')
    place = int(name[1:]) if name is not None and re.fullmatch(r"#[0-9]{1,9}", name) else 0
    if name is not None and names.count(name) != 1 and not 0 < place <= len(names):
        what = f'{names.count(name)} of its solids have the name "{name}" (expected 1); the names are {", ".join(names)}'
        raise refuse(str(path), what, f'{suggest_nearest(name, names)}; or use the number of the solid, "#1" to "#{len(names)}"')
    return solids[0 if name is None else names.index(name) if name in names else place - 1]


_BREP = re.compile(rb"=\s*MANIFOLD_SOLID_BREP\s*\(\s*'((?:[^']|'')*)'\s*,\s*(#\d+)\s*\)")
_SHELL = re.compile(rb"(#\d+)\s*=\s*CLOSED_SHELL\s*\(\s*'(?:[^']|'')*'\s*,\s*\(([^)]*)\)")


def _names(path: Path, solids: Sequence[occ.TopoDS_Shape]) -> list[str]:
    """Names of the solids in a file, or their numbers: the kernel drops names, so the file's own order is used."""
    text = path.read_bytes()
    faces = {shell: members.count(b"#") for shell, members in _SHELL.findall(text)}
    found = [(name.decode("utf-8", "replace").replace("''", "'"), faces.get(shell)) for name, shell in _BREP.findall(text)]
    alike = len(found) == len(solids) and all(count == len(solid.faces) for (_, count), solid in zip(found, solids, strict=True))
    return [found[place][0] if alike and found[place][0] else f"#{place + 1}" for place in range(len(solids))]
