"""Superelements: parts known by the stiffness and mass matrices of a finite element code, with any number of ports."""

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
    """Units of force, length and mass that a file of matrices is in; times are in seconds, angles in radians."""

    SI = "N-m-kg"
    MILLIMETRES = "N-mm-t"


@dataclass(frozen=True, eq=False)
class Port(Description):
    """An interface frame of a superelement, in the part's axes: its origin `at`, x along `along`, z along `up` (perpendicular to it).

    Its six coordinates (x, y, z, rx, ry, rz: its twist at its origin, in its axes) stand in the file's matrices from `row` on, counted
    from 1.
    """

    row: Annotated[int, Bound(1, 2**31)]
    at: Annotated[Vector, LENGTH]
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class MatrixNames(Description):
    """What the arrays of a MAT or NPZ file are called; without a name of its own the viscous damping is none."""

    stiffness: str = "K"
    mass: str = "M"
    damping: str = ""


@dataclass(frozen=True, eq=False)
class Superelement(Elastic):
    """An elastic body known by its stiffness K and mass M over the twists of its `ports` and inner coordinates, from files in `units`.

    Either `file` is a MAT or NPZ file of both (`arrays` says what they are called), or `stiffness_file` and `mass_file` are Matrix
    Market files. A matrix of viscous damping D may stand beside them (`arrays`, or `damping_file`). All coordinates that are no port's
    are inner ones: freedoms of nodes or amplitudes of modes, whatever the code has. `sha256` is the digest of the bytes of the file, or
    of all files one after the other (stiffness, mass, damping): it says which version is meant and stands for the matrices in caches. A
    relative path is looked for from the design file.

    The inner coordinates are reduced to modes with the ports held (Craig and Bampton, AIAA J. 6, 1313, 1968), which keeps the statics and
    the mass of the whole: as many as `modes` says (0: none, the condensation of Guyan, AIAA J. 3, 380, 1965), those `below` a frequency,
    or all. `mass`, `centre` of mass and `inertia` about it, in the part's axes, are for a check: what the matrices say must agree.
    `loss_factor` is that of its stiffness. `reflected`: it is the mirror image of the file's part across its x-z plane, as are the ports,
    mass, centre and inertia that are stated. Linear: small motions, no buckling; how it grows with temperature is not known.
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
        """None: it is a body, and rigid where bodies are; a link of it may state others."""
        return ()

    @property
    def is_axisymmetric(self) -> bool:
        """It is not: its axes are those of its file."""
        return False

    @property
    def mirrored(self) -> Superelement:
        """Its mirror image across its x-z plane: ports and what is stated of its mass stand on the other side."""
        ports = {name: replace(port, at=across(port.at), along=across(port.along), up=across(port.up)) for name, port in self.ports.items()}
        centre = None if self.centre is None else across(self.centre)
        inertia = None if self.inertia is None else self.inertia.mirrored
        return replace(self, ports=Table(ports), centre=centre, inertia=inertia, reflected=not self.reflected)

    @property
    def files(self) -> tuple[str, ...]:
        """The files it is known by, in the order in which their bytes are digested."""
        return (self.file,) if self.file else tuple(each for each in (self.stiffness_file, self.mass_file, self.damping_file) if each)

    @property
    def order(self) -> tuple[str, ...]:
        """The names of its ports in the order of their rows in the file."""
        return tuple(sorted(self.ports, key=lambda name: self.ports[name].row))
