"""Superelements: parts with stiffness and mass matrices from a finite-element code, and any number of ports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated, ClassVar

from flexstage.base.number import Number, Table, Vector
from flexstage.base.storage.digest import DOCUMENT_ONLY, Description
from flexstage.base.units.quantity import DIRECTION, FREQUENCY, LENGTH, MASS, NOT_NEGATIVE, POSITIVE, RATIO, Bound
from flexstage.parts.body import Inertia, across
from flexstage.parts.freedom import Freedom
from flexstage.parts.shape import Elastic


class FileUnits(Enum):
    """Units of force, length and mass of a matrix file; time in seconds, angles in radians."""

    SI = "N-m-kg"
    MILLIMETRES = "N-mm-t"


@dataclass(frozen=True, eq=False)
class Port(Description):
    """Port (interface frame) of a superelement, in the part's axes: origin `at`, x along `along`, z along `up`, perpendicular to x.

    The six coordinates (x, y, z, rx, ry, rz) of a port are its twist at its origin, in its axes. In the file's matrices, these coordinates
    begin at `row`, counted from 1.
    """

    row: Annotated[int, Bound(1, 2**31)]
    at: Annotated[Vector, LENGTH]
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class MatrixNames(Description):
    """Names of the arrays of a MAT or NPZ file; viscous damping is optional."""

    stiffness: str = "K"
    mass: str = "M"
    damping: str = ""


@dataclass(frozen=True, eq=False)
class Superelement(Elastic):
    """Superelement: its stiffness matrix K and mass matrix M, in `units`, are read from files.

    The coordinates of the matrices are the twists of the `ports` and internal coordinates. Either `file` is a MAT or NPZ file with both
    matrices (named in `arrays`), or `stiffness_file` and `mass_file` are Matrix Market files. A viscous damping matrix D is optional
    (`arrays`, or `damping_file`). Coordinates that do not belong to a port are internal: nodal degrees of freedom or modal amplitudes.
    `sha256` is the digest of the bytes of the file, or of all files in order (stiffness, mass, damping). The digest identifies the version
    of the matrices, and caches use the digest instead of the matrices. A relative path is relative to the design file.

    The internal coordinates are reduced to fixed-interface modes (Craig and Bampton, AIAA Journal 6, 1313, 1968). The reduction to modes
    preserves statics and total mass. `modes` limits the number of retained modes (0: Guyan condensation, AIAA Journal 3, 380, 1965), and
    `below` limits their frequencies. By default, the model keeps all modes.

    `mass`, `centre` of mass and `inertia` about this centre are specified in the part's axes and compared with the matrices. `loss_factor`
    is the loss factor of the stiffness. If `reflected`, the part is the mirror image of the file's part in the x-z plane; `ports`, `mass`,
    `centre` and `inertia` describe the mirror image. The model is linear (small motions, no buckling), and its thermal expansion is
    unknown.
    """

    kind: ClassVar[str] = "superelement"
    units: FileUnits
    ports: Mapping[str, Port]
    sha256: str = ""
    file: str = field(default="", metadata=DOCUMENT_ONLY)
    stiffness_file: str = field(default="", metadata=DOCUMENT_ONLY)
    mass_file: str = field(default="", metadata=DOCUMENT_ONLY)
    damping_file: str = field(default="", metadata=DOCUMENT_ONLY)
    arrays: MatrixNames = field(default_factory=MatrixNames)
    reflected: bool = False
    modes: Annotated[int, Bound(0, 10_000)] | None = None
    below: Annotated[Number, FREQUENCY, POSITIVE] | None = None
    mass: Annotated[Number, MASS, NOT_NEGATIVE] | None = None
    centre: Annotated[Vector, LENGTH] | None = None
    inertia: Inertia | None = None
    loss_factor: Annotated[Number, RATIO, NOT_NEGATIVE] | None = None
    source: str = field(default="", metadata=DOCUMENT_ONLY)

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom: none, as for a rigid body, but a link may specify free degrees of freedom."""
        return ()

    @property
    def is_axisymmetric(self) -> bool:
        """False, because the file determines the axes of a superelement."""
        return False

    @property
    def mirrored(self) -> Superelement:
        """Mirror image in the x-z plane, including ports and specified mass properties."""
        ports = {name: replace(port, at=across(port.at), along=across(port.along), up=across(port.up)) for name, port in self.ports.items()}
        centre = None if self.centre is None else across(self.centre)
        inertia = None if self.inertia is None else self.inertia.mirrored
        return replace(self, ports=Table(ports), centre=centre, inertia=inertia, reflected=not self.reflected)

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the superelement's files, in the order of the digest."""
        return (self.file,) if self.file else tuple(each for each in (self.stiffness_file, self.mass_file, self.damping_file) if each)

    @property
    def order(self) -> tuple[str, ...]:
        """Names of the superelement's ports in the order of their rows in the file."""
        return tuple(sorted(self.ports, key=lambda name: self.ports[name].row))
