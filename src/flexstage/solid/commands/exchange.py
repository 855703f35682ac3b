"""Commands for files of solids: `cad` writes a stage (STEP, VTU, GLB), `import` reads a STEP file, `superelement` writes matrices."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from flexstage.analysis.complete import platform_modes
from flexstage.base.finding import refuse, require, suggest_nearest
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import load, outline_text, part_text
from flexstage.show.command.design import open_design
from flexstage.show.command.options import Changes, Design, modes_option, order_option, output_option, text_option
from flexstage.show.command.output import announce, save
from flexstage.show.command.progress import progress_bar
from flexstage.show.command.terminal import print_result, print_warning
from flexstage.solid.exchange.matrices import export_superelement
from flexstage.solid.fea.geometry.sound import stage_findings
from flexstage.solid.fea.jobs.apart import step_apart
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.install import require_solver
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import read_solid, solids


def cad(
    design: Design,
    *,
    output: Annotated[Path | None, output_option("STAGE.STEP", "STEP file of the named solids.")] = None,
    mesh: Annotated[Path | None, text_option("--mesh", "STAGE.VTU", "VTU file of the mesh.")] = None,
    gltf: Annotated[Path | None, text_option("--gltf", "STAGE.GLB", "GLB file of animated modes.")] = None,
    order: Annotated[int, order_option(min=1)] = 2,
    modes: Annotated[int, modes_option(min=0, max=100)] = 12,
    changes: Changes = None,
) -> None:
    """Write the solids, mesh or animated modes of a stage.

    Writes a STEP assembly of named solids (--output), the mesh (--mesh) or animated modes (--gltf). --order applies to --mesh and
    --gltf; --modes applies to --gltf.

    Gaps, overlaps and nearly coincident faces are errors with --mesh and --gltf, otherwise warnings.
    """
    targets = {"--output": output, "--mesh": mesh, "--gltf": gltf}
    if not any(targets.values()):
        raise refuse("--output", "missing", "Use -o stage.step, --mesh stage.vtu or --gltf stage.glb")
    mechanism = open_design(design, changes, list(targets.items()))
    for path, option, content in _contents(mechanism, targets, order, modes):
        save(path, content, option)


def state(
    part: Annotated[Path, typer.Argument(metavar="PART.STEP", help="STEP file of one solid or of an assembly.", show_default=False)],
    design: Design,
    *,
    material: Annotated[
        str | None,
        typer.Option(
            "--material",
            help="Material of the solid. Required if the design has several materials. Default: the material of the design.",
            show_default=False,
        ),
    ] = None,
    body: Annotated[str, typer.Option("--body", metavar="NAME", help="Body to which the outline belongs.")] = "platform",
    solid: Annotated[
        str | None,
        typer.Option("--solid", metavar="NAME", help="Solid to import from an assembly, by name or number, e.g. #2.", show_default=False),
    ] = None,
) -> None:
    """Import a STEP file as an outline (solid shape) of a body.

    Prints the TOML table of the outline for the design file: file, digest (checksum), size, mass, centre of mass and inertia.

    Models with rigid bodies use these values. The solid model uses the geometry of the file, and compares the values with this geometry.
    """
    mechanism = load(design)
    chosen = _material(mechanism, material)
    require_solver()
    from flexstage.solid.fea.geometry.imported import measure, with_properties  # needs the solver

    density = float(mechanism.materials[chosen].density)
    stated = with_properties(measure(part, solid), str(part.resolve()), chosen, density, solid)
    print_result(outline_text(body, part.stem if solid is None else solid.lstrip("#"), stated, design.parent))


def superelement(
    design: Design,
    solid: Annotated[str, typer.Argument(metavar="SOLID", help="Body or link that belongs to the solid.", show_default=False)],
    *,
    output: Annotated[Path, output_option("FRAME.NPZ", "NPZ file of the stiffness and mass matrices.")],
    order: Annotated[int, order_option(min=1)] = 3,
    modes: Annotated[int, modes_option(min=0, max=100)] = 12,
    changes: Changes = None,
) -> None:
    """Reduce one solid of a stage to a superelement.

    Writes the stiffness and mass matrices of the superelement. Their coordinates are the motions of the ports and the modes with fixed
    ports. Prints the TOML table of the superelement, for a design file in the same folder as the matrices.

    The solid consists of SOLID and of all links and bodies that form one piece with it. A port is the end face of a link that joins the
    solid to another body, to a stack or to the ground.
    """
    mechanism = open_design(design, changes, [("--output", output)])
    require_solver()
    reduction = Reduction(Fineness(order=order), modes)
    with progress_bar() as shown:
        part = export_superelement(mechanism, solid, output, reduction, progress=shown.step)
    announce(f"Wrote {output}")
    print_result(part_text(solid.replace("/", "-"), part, output.parent))


def _material(mechanism: Mechanism, name: str | None) -> str:
    known = tuple(mechanism.materials)
    if name is None and len(known) == 1:
        return known[0]
    if name is None or name not in known:
        what = f"the design has {len(known)} materials" if name is None else f"the design has no material {name}"
        raise refuse("--material", what, f"Specify one. {suggest_nearest(name or '', known)}")
    return name


def _contents(mechanism: Mechanism, targets: dict[str, Path | None], order: int, modes: int) -> Iterator[tuple[Path, str, bytes]]:
    """The requested files, with their options, one after the other."""
    require_solver()
    stage, fineness = with_drawn_parts(mechanism), Fineness(order=order)
    _check_contact(stage, meshed=targets["--mesh"] is not None or targets["--gltf"] is not None)
    if (path := targets["--output"]) is not None:
        yield path, "--output", step_apart(stage)
    if (path := targets["--mesh"]) is not None:
        from flexstage.solid.exchange.vtu import stage_mesh, vtu  # needs a package of the extra `solid`

        with progress_bar() as shown:
            mesh = stage_mesh(stage, fineness, progress=shown.step)
        yield path, "--mesh", vtu(mesh)
    if (path := targets["--gltf"]) is not None:
        yield path, "--gltf", _moving_parts(stage, fineness, modes)


def _check_contact(stage: Mechanism, *, meshed: bool) -> None:
    """Errors prevent meshing a stage, but not drawing it for a repair in CAD."""
    findings = stage_findings(stage, Cache())
    if meshed:
        require(findings)
    for finding in findings:
        print_warning(finding)


def _moving_parts(stage: Mechanism, fineness: Fineness, count: int) -> bytes:
    """The GLB file of a stage with its lowest modes."""
    from flexstage.solid.exchange.gltf import Motion, gltf, surfaces  # needs a package of the extra `solid`

    with progress_bar() as shown:
        read = read_solid(stage, Reduction(fineness), solids(Ways(progress=shown.step, notice=print_warning)))
    found = platform_modes(stage, read.model)
    motions = [
        Motion(f"mode {number + 1}: {name}, {found.frequencies[number]:.1f} Hz", found.shapes[:, number])
        for number, name in enumerate(found.names[:count])
    ]
    return gltf(stage.name or "stage", surfaces(read.placed, motions), motions)
