"""How the stored numbers of test_notch_elements.py were made: circular notches in NGSolve 6.2 (`pip install ngsolve`; not a dependency).

Run as a script. `hinge` gives the compliance of a notch between rigid faces at its arc ends, by curved elements of order 4; `throat` the
largest stress in a plane-stress hinge with full-height blocks over the nominal one at the throat, in tension and in bending, by order 6.
"""

from __future__ import annotations

import sys

import numpy as np

E, NU = 200e3, 0.3
HINGES = ((1.54, 3, 10), (1, 5, 10), (0.85, 5, 14.9), (1, 5, 30), (1, 5, 5), (1, 5, 2), (1, 5, 1), (1, 2, 50.3), (3, 3, 12))
CIRCLES = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
FILLETS = ((1.0, 0.5, 6.0), (1.0, 1.0, 8.0), (1.0, 2.0, 10.0))


def hinge(thickness, radius, width, order=4, stub=0.0):
    """The diagonal of the compliance about the centre [N, mm]; a gap of 0.01 mm keeps arcs below 180 degrees when there are stubs."""
    import ngsolve as ng
    from netgen.occ import Box, Cylinder, OCCGeometry, Pnt, Z

    height, end, cut = thickness + 2 * radius, radius + stub, radius - (0.01 if stub else 0.0)
    solid = Box(Pnt(-end, -height / 2, -width / 2), Pnt(end, height / 2, width / 2))
    for side in (1, -1):
        solid -= Cylinder(Pnt(0, side * (cut + thickness / 2), -width), Z, cut, 2 * width)
    for face in solid.faces:
        face.name = {-1: "fixed", 1: "moved"}.get(round(face.center.x / end, 6), "free")
    mesh = ng.Mesh(OCCGeometry(solid).GenerateMesh(maxh=min(width, height) / 2, parallel_meshing=False))
    _refine(mesh, 1.2 * thickness, 0.5 * np.sqrt(thickness * radius), order)
    x, y, z = ng.x, ng.y, ng.z
    motions = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0, -z, y), (z, 0, -x), (-y, x, 0)]
    stiffness, _ = _solve(mesh, order, motions, 3)
    return np.diag(np.linalg.inv(stiffness))


def _refine(mesh, size, reach, order):
    mesh.Curve(order)
    for _ in range(3):
        for element in mesh.Elements():
            corners = np.array([mesh[vertex].point for vertex in element.vertices])
            longest = max(np.linalg.norm(a - b) for a in corners for b in corners)
            mesh.SetRefinementFlag(element, bool(longest > size * (1 + abs(corners[:, 0].mean()) / reach)))
        mesh.Refine()
        mesh.Curve(order)


def _solve(mesh, order, motions, dimension):
    """Stiffness of the moved face for the motions, and the displacement fields; plane stress in two dimensions."""
    import ngsolve as ng

    space = ng.VectorH1(mesh, order=order, dirichlet="fixed|moved")
    u, v = space.TnT()
    shear = E / 2 / (1 + NU)
    bulk = E * NU / (1 - NU**2) if dimension == 2 else E * NU / (1 + NU) / (1 - 2 * NU)

    def stress(w):
        strain = 0.5 * (ng.Grad(w) + ng.Grad(w).trans)
        return 2 * shear * strain + bulk * ng.Trace(strain) * ng.Id(dimension)

    form = ng.BilinearForm(space, symmetric=True)
    form += ng.InnerProduct(stress(u), ng.Grad(v)) * ng.dx
    with ng.TaskManager():
        form.Assemble()
        inverse = form.mat.Inverse(space.FreeDofs(), inverse="sparsecholesky")
        fields = []
        for motion in motions:
            field = ng.GridFunction(space)
            field.Set(ng.CF(motion), definedon=mesh.Boundaries("moved"))
            residual = (-form.mat * field.vec).Evaluate()
            field.vec.data += inverse * residual
            fields.append(field)
        forces = [(form.mat * field.vec).Evaluate() for field in fields]
    return np.array([[ng.InnerProduct(force, field.vec) for field in fields] for force in forces]), [stress(field) for field in fields]


def throat(thickness, radius, length=None, order=6):
    """Largest over nominal stress in tension and in bending; `length` of a corner-filleted hinge, absent for a circular one."""
    import ngsolve as ng
    from netgen.occ import Circle, OCCGeometry, Rectangle

    height = thickness + 2 * radius
    middle = 0.0 if length is None else length / 2 - radius
    end = middle + radius + (2 * height if length else radius)
    plate = Rectangle(2 * end, height).Face().Move((-end, -height / 2, 0))
    for side in (1, -1):
        for centre in {middle, -middle}:
            plate -= Circle((centre, side * (radius + thickness / 2)), radius * (1.0 if length else 0.9999)).Face()
        if length:
            plate -= Rectangle(2 * middle, radius + 1).Face().Move((-middle, thickness / 2 if side > 0 else -thickness / 2 - radius - 1, 0))
    for edge in plate.edges:
        edge.name = {-1: "fixed", 1: "moved"}.get(round(edge.center.x / end, 6), "free")
    mesh = ng.Mesh(OCCGeometry(plate, dim=2).GenerateMesh(maxh=min(thickness / 3, radius / 4), parallel_meshing=False))
    mesh.Curve(order)
    stiffness, fields = _solve(mesh, order, [(1, 0), (-ng.y, ng.x)], 2)
    nominal = stiffness[0, 0] / thickness, 6 * stiffness[1, 1] / thickness**2
    angles = np.linspace(0.0, 1.2, 241)
    outline = [(middle + radius * np.sin(p), thickness / 2 + radius * (1 - np.cos(p)) - 1e-6 * radius) for p in angles]
    largest = [max(np.abs(np.linalg.eigvalsh(np.reshape(field(mesh(*point)), (2, 2)))).max() for point in outline) for field in fields]
    return tuple(value / reference for value, reference in zip(largest, nominal, strict=True))


def main():
    write = sys.stdout.write
    for size in HINGES:
        write(f"{size}: {np.array2string(hinge(*size), precision=5, max_line_width=140)}\n")
    for ratio in CIRCLES:
        write("circle t/R = {}: {:.3f} {:.3f}\n".format(ratio, *throat(ratio, 1.0)))
    for radius, thickness, length in FILLETS:
        write("fillet r = {}, t = {}, l = {}: {:.3f} {:.3f}\n".format(radius, thickness, length, *throat(thickness, radius, length)))
    for stub in (5, 10):
        write(f"with stubs of {stub}: {np.array2string(hinge(1.54, 3, 10, stub=stub), precision=5, max_line_width=140)}\n")


if __name__ == "__main__":
    main()
