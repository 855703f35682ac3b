"""Laws of superelements: random bodies with rigid motions of their own, any number of ports, files of every kind."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.finding import DesignError
from flexstage.beams.compliance import law
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.assembly.pattern import Normal, Pose
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Placement, Unit
from flexstage.mechanism.store import dump, load
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.linear.frequency import transfer
from flexstage.models.linear.port import ports
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.parts import matrix_file
from flexstage.parts.body import Body, Inertia
from flexstage.parts.condensation import condense, superelement
from flexstage.parts.freedom import Freedom
from flexstage.parts.superelement import FileUnits, MatrixNames, Port, Superelement
from flexstage.show.scene.stage import scene
from flexstage.show.viewer.data import still_data
from flexstage.spatial.frame import COMPONENTS, FORCES, Frame, axes, mirror, rigid_inertia, spatial_rotation, transport, twist_transform
from tests.conftest import examples

NAMES = ("left", "right", "top", "arm", "foot")
MASS, CENTRE = 2.0, (0.01, -0.02, 0.03)
MOMENTS = Inertia(0.02, 0.03, 0.035)
TENSOR = np.diag([0.02, 0.03, 0.035])
LOAD = Inertia(2e-3, 3e-3, 4e-3)


@dataclass(frozen=True)
class Elastic:
    """Matrices of a free body over ports and inner coordinates, SI, ports first, and the frames of its ports."""

    stiffness: np.ndarray
    mass: np.ndarray
    ports: dict[str, Port]

    @property
    def frames(self):
        return [Frame(axes(port.along, port.up), np.array(port.at)) for port in self.ports.values()]


def elastic(seed, ports=3, inner=8):
    """A random one: stiffness and mass of no structure but that rigid motions are free and have the mass of a body."""
    random = np.random.default_rng(seed)
    along, across, places = random.normal(size=(3, ports, 3))
    up = np.cross(along, across)
    stated = {
        name: Port(1 + 6 * number, at=tuple(0.1 * places[number]), along=tuple(along[number]), up=tuple(up[number]))
        for number, name in enumerate(NAMES[:ports])
    }
    found = Elastic(np.zeros(0), np.zeros(0), stated)
    moving = np.vstack([*(twist_transform(frame, np.zeros(3)) for frame in found.frames), random.normal(size=(inner, 6))])
    away = np.eye(len(moving)) - moving @ np.linalg.pinv(moving)
    springs, weights = (each @ each.T for each in random.normal(size=(2, len(moving), len(moving))))
    own = np.linalg.pinv(moving).T @ rigid_inertia(MASS, TENSOR, np.array(CENTRE), np.zeros(3)) @ np.linalg.pinv(moving)
    return Elastic(1e6 * away @ springs @ away, 0.1 * away @ weights @ away + own, stated)


def part_of(body, folder, damping=None, **stated):
    """The body as a part, by a file in a folder."""
    np.savez(folder / "body.npz", K=body.stiffness, M=body.mass, **({} if damping is None else {"D": damping}))
    return superelement(Superelement(FileUnits.SI, body.ports, file=str(folder / "body.npz"), **stated))


def stage(part, at=(0.0, 0.0, 0.0), along=(1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)):
    """The part on the ground by its first port, the platform at its second, a body each at the others."""
    names = part.order
    joins = dict(zip(names, ("ground", "platform", *names[2:]), strict=False))
    bodies = {"platform": Body(mass=0.5, centre=(0.0, 0.0, 0.05), inertia=LOAD), **{name: Body() for name in names[2:]}}
    link = Link(joins, "body", at=at, along=along, bends=bends)
    return Mechanism("superelement", parts={"body": part}, bodies=bodies, links={"frame": link})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("matrices")


TWIST, WRENCH = (tuple(f"platform.{name}" for name in names) for names in (COMPONENTS, FORCES))
seeds = st.integers(0, 2**32 - 1)


def close(found, wanted, share=1e-9):
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=share * np.max(np.abs(wanted)))


@examples(8)
@given(seeds, st.integers(2, 5), st.integers(0, 9), st.integers(0, 9))
def test_statics_and_mass_are_those_of_the_whole_whatever_is_kept_within(folder, seed, ports, inner, kept):
    """Guyan and Craig-Bampton: compliance at the ports as of all coordinates, and the mass of a rigid motion to rounding."""
    body = elastic(seed, ports, inner)
    found = condense(part_of(body, folder, modes=kept, mass=MASS, centre=CENTRE, inertia=MOMENTS))
    whole = np.linalg.inv(body.stiffness[6:, 6:])[: 6 * ports - 6, : 6 * ports - 6]
    close(np.linalg.inv(found.stiffness), whole, 1e-7)
    assert len(found.squares) == min(kept, inner)
    rigid = np.vstack([*(twist_transform(frame, np.zeros(3)) for frame in body.frames), np.zeros((len(found.squares), 6))])
    close(rigid.T @ found.inertia @ rigid, rigid_inertia(MASS, TENSOR, np.array(CENTRE), np.zeros(3)), 1e-12)


@examples(7)
@given(seeds)
def test_all_modes_are_those_of_the_matrices(folder, seed):
    """With every inner mode kept, nothing of the dynamics is lost."""
    body = elastic(seed)
    made = replace(stage(part_of(body, folder)), bodies={"platform": Body(), "top": Body()})
    wanted = scipy.linalg.eigvalsh(body.mass[6:, 6:], body.stiffness[6:, 6:])[::-1]
    np.testing.assert_allclose(1.0 / eigen(lumped(made)).values, wanted, rtol=1e-7, atol=1e-10 * wanted[0])


@examples(7)
@given(seeds, st.randoms(use_true_random=False))
def test_the_order_of_ports_and_of_rows_is_of_no_account(folder, seed, random):
    """Rows exchanged in the file and stated so, ports named in another order: the same stage, and so with another port first."""
    body = elastic(seed)
    size = len(body.stiffness)
    blocks = [list(range(6 * number, 6 * number + 6)) for number in range(3)] + [[row] for row in range(18, size)]
    order = random.sample(range(len(blocks)), len(blocks))
    rows = [row for block in order for row in blocks[block]]
    ports = {name: replace(port, row=1 + rows.index(port.row - 1)) for name, port in body.ports.items()}
    names = random.sample(list(ports), 3)
    moved = Elastic(body.stiffness[np.ix_(rows, rows)], body.mass[np.ix_(rows, rows)], {name: ports[name] for name in names})
    made = stage(part_of(body, folder))
    models = [lumped(made), lumped(replace(made, parts={"body": part_of(moved, folder)}))]
    close(*(static_gain(model, TWIST, WRENCH).values for model in reversed(models)), 1e-8)
    np.testing.assert_allclose(eigen(models[1]).values, eigen(models[0]).values, rtol=1e-6)


@examples(7)
@given(seeds)
def test_the_frame_it_is_placed_in_turns_and_shifts_all(folder, seed):
    """The same part elsewhere: compliance at its own platform point, in its own axes, is the same."""
    part = part_of(elastic(seed), folder)
    random = np.random.default_rng(seed)
    along, across, at = random.normal(size=(3, 3))
    placed = Frame(axes(tuple(along), tuple(np.cross(along, across))), at)
    models = []
    for frame in (Frame(np.eye(3), np.zeros(3)), placed):
        centre = frame.point(np.array([0.0, 0.0, 0.05]))
        made = stage(part, at=tuple(frame.position), along=tuple(frame.rotation[:, 0]), bends=tuple(frame.rotation[:, 2]))
        platform = Body(reference=tuple(centre))
        gain = static_gain(lumped(replace(made, bodies={**made.bodies, "platform": platform})), TWIST, WRENCH).values
        turn = spatial_rotation(frame.rotation)
        models.append(turn.T @ gain @ turn)
    close(models[1], models[0], 1e-8)


@examples(7)
@given(seeds)
def test_in_a_mirror_everything_is_mirrored(folder, seed):
    """The reflected part, and a unit of it placed in a mirror: compliance as of a stage seen in a mirror, and its image is itself."""
    body = elastic(seed)
    part = part_of(body, folder, mass=MASS, centre=CENTRE, inertia=MOMENTS)
    seen = mirror(1) @ static_gain(lumped(stage(part)), TWIST, WRENCH).values @ mirror(1)
    close(static_gain(lumped(stage(part.mirrored)), TWIST, WRENCH).values, seen, 1e-8)
    assert part.mirrored.mirrored == part
    made = stage(part)
    unit = Unit({}, made.links)
    placed = replace(made, links={}, units={"half": unit}, placements={"far": Placement("half", Pose(mirror=Normal.Y))})
    close(static_gain(lumped(placed), TWIST, WRENCH).values, seen, 1e-8)


@examples(7)
@given(seeds)
def test_wrenches_at_the_ports_balance_and_carry_the_load(folder, seed):
    """A wrench on the platform passes the platform's port; all ports together are in equilibrium; a free body's port carries nothing."""
    made = stage(part_of(elastic(seed), folder))
    model = lumped(made)
    names = tuple(f"frame.{port}.{force}" for port in NAMES[:3] for force in FORCES)
    passed = static_gain(model, names, WRENCH).values.reshape(3, 6, 6)
    frames = elastic(seed).frames
    seen = [twist_transform(frame, np.array([0.0, 0.0, 0.05])).T @ wrench for frame, wrench in zip(frames, passed, strict=True)]
    np.testing.assert_allclose(seen[1], np.eye(6), atol=1e-7)
    np.testing.assert_allclose(seen[0], -np.eye(6), atol=1e-7)
    np.testing.assert_allclose(seen[2], 0.0, atol=1e-7)


def damping_of(body, seed):
    """Random damping of all but rigid motions."""
    moving = np.linalg.svd(body.stiffness)[0][:, :-6]
    random = np.random.default_rng(seed).normal(size=(moving.shape[1], moving.shape[1]))
    return 50.0 * moving @ random @ random.T @ moving.T


@examples(5)
@given(seeds)
def test_its_own_damping_is_that_of_the_matrices(folder, seed):
    """Responses at the platform with every inner mode kept: those of K, M and D of the file."""
    body = elastic(seed)
    damping = damping_of(body, seed)
    made = stage(part_of(body, folder, damping, arrays=MatrixNames(damping="D")))
    made = replace(made, bodies={"platform": Body(reference=body.ports["right"].at), "top": Body()})
    hertz = np.array([0.5, 1.1]) * np.sqrt(eigen(lumped(made)).values[[0, 3]]) / (2.0 * np.pi)
    model = lumped(made)
    found = transfer(model, ports(model, TWIST, WRENCH), hertz, ModalDamping(0.0))
    turn = spatial_rotation(body.frames[1].rotation)
    for seen, omega in zip(found, 2.0 * np.pi * hertz, strict=True):
        dynamic = (body.stiffness + 1j * omega * damping - omega**2 * body.mass)[6:, 6:]
        close(seen, turn @ np.linalg.inv(dynamic)[:6, :6] @ turn.T, 1e-7)


def test_damping_that_resists_rigid_motions_is_told(tmp_path):
    body = elastic(25)
    with pytest.raises(DesignError, match="damping matrix: resists rigid motions"):
        part_of(body, tmp_path, body.mass, arrays=MatrixNames(damping="D"))
    with pytest.raises(DesignError, match="damping matrix: has a negative eigenvalue"):
        part_of(body, tmp_path, -damping_of(body, 25), arrays=MatrixNames(damping="D"))


def test_its_weight_is_borne_by_the_ground(folder):
    """What weight passes into the ground port, and what of the part's mass hangs on that port itself, is the weight of all."""
    body = elastic(3)
    model = lumped(stage(part_of(body, folder)))
    names = tuple(f"frame.left.{force}" for force in FORCES)
    fall = np.linalg.solve(model.stiffness_matrix, model.base_inertia[:, 2])
    passed = model.output[model.output_index(names)] @ fall
    frame = body.frames[0]
    found = condense(part_of(body, folder))
    rigid = np.vstack([*(twist_transform(each, np.zeros(3)) for each in body.frames), np.zeros((len(found.squares), 6))])
    own = (found.inertia @ rigid)[:6, 2]
    np.testing.assert_allclose(frame.rotation @ (own - passed)[:3], [0.0, 0.0, MASS + 0.5], atol=1e-9)


def test_it_is_rigid_to_the_ideal_model_or_free_as_its_link_states(folder):
    """All bodies at its ports move as one; of two ports the link may state freedoms, as of any hinge."""
    three = stage(part_of(elastic(5), folder))
    assert ideal(three).mobility == 0
    two = stage(part_of(elastic(5, ports=2), folder))
    hinge = replace(two.links["frame"], free=(Freedom.RZ,))
    assert ideal(two).mobility == 0
    assert ideal(replace(two, links={"frame": hinge})).mobility == 1
    told = check(replace(three, links={"frame": replace(three.links["frame"], free=(Freedom.RZ,))}))
    assert "two ports" in str(told[0])


def test_a_hinge_by_its_matrices_loses_what_the_drawn_one_loses(tmp_path):
    """A leaf as a superelement between its ends: lost motion and its budget are those of the leaf, as its link states its freedoms."""
    drawn = parallelogram()
    leaf, half = drawn.parts["leaf"], 0.5 * drawn.parts["leaf"].length
    ends = np.hstack([-transport(np.array([half, 0.0, 0.0])), transport(np.array([-half, 0.0, 0.0]))])
    stiffness = ends.T @ law(leaf, drawn.materials[leaf.material]).stiffness @ ends
    ports = {"near": Port(1, at=(-half, 0.0, 0.0)), "far": Port(7, at=(half, 0.0, 0.0))}
    part = part_of(Elastic(stiffness, np.zeros((12, 12)), ports), tmp_path)
    left = drawn.links["left"]
    joins = dict(zip(("near", "far"), left.joins, strict=True))
    made = replace(
        drawn,
        parts={**drawn.parts, "known": part},
        links={**drawn.links, "left": replace(left, joins=joins, part="known", free=leaf.intended)},
    )
    wanted, found = (lost_motion(ideal(each), lumped(each)) for each in (drawn, made))
    close(found.loss.values, wanted.loss.values, 1e-6)
    close(sum(each.values for each in found.budget.values()), found.loss.values, 1e-6)
    close(found.gain.values, wanted.gain.values)


def test_pictures_show_it_between_its_ports_and_bend_it_with_their_bodies(folder):
    made = stage(part_of(elastic(5), folder))
    bars = [piece for piece in scene(made).pieces if piece.name == "frame"]
    assert {piece.bodies for piece in bars} == {("ground", "platform"), ("ground", "top"), ("platform", "top")}
    shown = still_data(made)
    own = shown.mesh.part == [thing.name for thing in shown.things].index("frame")
    ends = {tuple(shown.bodies[number] for number in shown.mesh.bodies[carrier]) for carrier in shown.mesh.carrier[own]}
    assert ends == {piece.bodies for piece in bars}


@pytest.mark.parametrize("form", ["npz", "mat", "sparse", "mat73", "mtx", "mtx dense", "millimetres"])
def test_every_form_of_file_says_the_same(tmp_path, form):
    body = elastic(7)
    wanted = condense(part_of(body, tmp_path))
    found = condense(superelement(written(body, tmp_path, form)))
    for name in ("stiffness", "squares", "inertia"):
        close(getattr(found, name), getattr(wanted, name), 1e-9)


def test_matrices_too_large_to_be_dense_are_worked_on_as_they_are(tmp_path, monkeypatch):
    body = elastic(27, inner=30)
    dense = condense(replace(part_of(body, tmp_path), modes=5))
    monkeypatch.setattr(matrix_file, "LARGEST_DENSE", 10)
    part = written(body, tmp_path, "mtx")
    with pytest.raises(DesignError, match="Limit the number of modes"):
        superelement(part)
    found = condense(superelement(replace(part, modes=5)))
    for name in ("stiffness", "squares"):
        close(getattr(found, name), getattr(dense, name), 1e-8)
    close(np.abs(found.inertia), np.abs(dense.inertia), 1e-7)  # modes have no sign


@pytest.mark.parametrize("sign", [-1.0, 0.0])
def test_large_matrices_that_are_not_positive_within_are_refused(tmp_path, monkeypatch, sign):
    monkeypatch.setattr(matrix_file, "LARGEST_DENSE", 10)
    body = elastic(29, inner=30)
    weak = body.stiffness.copy()
    weak[18:, 18:] *= sign
    with pytest.raises(DesignError, match="stiffness matrix"):
        superelement(replace(written(broken(body, stiffness=weak), tmp_path, "mtx"), modes=5))


def written(body, folder, form):
    """The body as a part by a file of the form."""
    common = {"ports": body.ports}
    if form == "npz":
        np.savez(folder / "other.npz", k=body.stiffness, m=body.mass)
        return Superelement(FileUnits.SI, file=str(folder / "other.npz"), arrays=MatrixNames("k", "m"), **common)
    if form in ("mat", "sparse"):
        form_of = scipy.sparse.csc_matrix if form == "sparse" else np.asarray
        scipy.io.savemat(folder / "other.mat", {"K": form_of(body.stiffness), "M": form_of(body.mass)})
        return Superelement(FileUnits.SI, file=str(folder / "other.mat"), **common)
    if form == "mat73":
        import h5py

        with h5py.File(folder / "other.mat", "w", userblock_size=512) as file:
            file["K"], file["M"] = body.stiffness, body.mass
        return Superelement(FileUnits.SI, file=str(folder / "other.mat"), **common)
    if form == "millimetres":
        scale = np.concatenate([np.tile(np.repeat([1e-3, 1.0], 3), 3), np.ones(8)])
        stiffness, mass = (1e3 * scale * each * scale[:, None] for each in (body.stiffness, body.mass))
        np.savez(folder / "other.npz", K=stiffness, M=mass)
        return Superelement(FileUnits.MILLIMETRES, file=str(folder / "other.npz"), **common)
    form_of = np.asarray if form == "mtx dense" else scipy.sparse.coo_matrix
    for name, matrix in (("K", body.stiffness), ("M", body.mass)):
        scipy.io.mmwrite(folder / f"{name}.mtx", form_of(0.5 * (matrix + matrix.T)), symmetry="symmetric", precision=17)
    return Superelement(FileUnits.SI, stiffness_file=str(folder / "K.mtx"), mass_file=str(folder / "M.mtx"), **common)


def test_a_design_file_keeps_it_beside_itself(tmp_path):
    made = stage(part_of(elastic(9), tmp_path, modes=4, loss_factor=0.01))
    path = dump(made, tmp_path / "stage.toml")
    assert 'file = "body.npz"' in path.read_text()
    assert load(path) == made


def broken(body, **changed):
    return Elastic(changed.get("stiffness", body.stiffness), changed.get("mass", body.mass), changed.get("ports", body.ports))


def skew(matrix):
    matrix = np.array(matrix)
    matrix[0, 8] += 0.01 * np.max(np.abs(matrix))
    return matrix


WRONG = {
    "not square": (lambda body: broken(body, stiffness=body.stiffness[:-1]), "stiffness matrix: not square (got 25 x 26)"),
    "of two sizes": (
        lambda body: broken(body, mass=body.mass[:-1, :-1]),
        "26 x 26, 25 x 25",
    ),
    "not symmetric": (lambda body: broken(body, stiffness=skew(body.stiffness)), "not symmetric: entry (1, 9)"),
    "not finite": (lambda body: broken(body, mass=np.full_like(body.mass, np.nan)), "676 of its entries are not finite"),
    "negative mass": (lambda body: broken(body, mass=-body.mass), "negative"),
    "negative in one motion": (lambda body: broken(body, mass=body.mass - 3.0 * np.diag([0.0] * 18 + [1.0] * 8)), "negative"),
    "negative stiffness": (lambda body: broken(body, stiffness=-body.stiffness), "zero or negative stiffness"),
    "held": (lambda body: broken(body, stiffness=body.stiffness + 1e4 * np.eye(26)), "rigid motion of all ports has a stiffness"),
    "rows too far": (lambda body: broken(body, ports={**body.ports, "top": replace(body.ports["top"], row=22)}), "end at row 27"),
    "rows twice": (lambda body: broken(body, ports={**body.ports, "top": replace(body.ports["top"], row=9)}), "overlap with another port"),
    "one port": (lambda body: broken(body, ports={"left": body.ports["left"]}), "too few ports (got 1, expected 2 or more)"),
    "rows exchanged": (
        lambda body: broken(
            body, ports={**body.ports, "left": replace(body.ports["left"], row=7), "right": replace(body.ports["right"], row=1)}
        ),
        "Exchange the rows of right and left",
    ),
    "places in metres": (
        lambda body: broken(
            body, ports={name: replace(port, at=tuple(1e-3 * each for each in port.at)) for name, port in body.ports.items()}
        ),
        "or move the ports a thousand times farther apart",
    ),
    "a frame turned": (
        lambda body: broken(body, ports={**body.ports, "top": replace(body.ports["top"], along=(1.0, 0.0, 0.0), up=(0.0, 0.0, 1.0))}),
        "rigid motion of all ports has a stiffness",
    ),
}


@pytest.mark.parametrize("fault", WRONG)
def test_matrices_that_are_wrong_are_refused_with_what_is_found(tmp_path, fault):
    change, told = WRONG[fault]
    with pytest.raises(DesignError) as caught:
        part_of(change(elastic(11)), tmp_path)
    assert told in str(caught.value)
    assert "superelement" in str(caught.value)


def test_units_that_are_not_the_files_are_told(tmp_path):
    part = replace(written(elastic(13), tmp_path, "millimetres"), units=FileUnits.SI)
    with pytest.raises(DesignError, match='Use units = "N-mm-t"'):
        superelement(part)


@pytest.mark.parametrize(
    ("stated", "told"),
    [
        ({"mass": 2.1}, "got 2.1 kg"),
        ({"centre": (0.0, 0.0, 0.0)}, "37.4"),
        ({"inertia": Inertia(0.03, 0.03, 0.03)}, "differs by 0.01"),
    ],
)
def test_a_stated_body_that_the_matrices_are_not_is_told(tmp_path, stated, told):
    with pytest.raises(DesignError) as caught:
        part_of(elastic(15), tmp_path, **stated)
    assert told in str(caught.value)


def test_mass_on_some_directions_alone_is_told(tmp_path):
    body = elastic(17)
    with pytest.raises(DesignError, match="which should be equal"):
        part_of(broken(body, mass=np.diag(np.diag(body.mass))), tmp_path)


FILES = {
    "missing": (lambda path: path.unlink(), "file not found"),
    "truncated": (lambda path: path.write_bytes(path.read_bytes()[:5000]), "it cannot be read as an NPZ file"),
    "damaged": (lambda path: path.write_bytes(path.read_bytes()[:3000] + bytes(200) + path.read_bytes()[3200:]), ""),
    "of text": (lambda path: path.write_text("stiffness"), "it cannot be read as an NPZ file"),
    "without mass": (lambda path: np.savez(path, K=np.eye(12)), 'has no array "M"; it has K'),
    "of objects": (lambda path: np.savez(path, K=np.array([{}, None], dtype=object), M=np.eye(12)), "it cannot be read as an NPZ file"),
    "of complex numbers": (lambda path: np.savez(path, K=1j * np.eye(12), M=np.eye(12)), "complex numbers"),
    "of one row": (lambda path: np.savez(path, K=np.zeros(12), M=np.eye(12)), "not square (got 12)"),
    "empty": (lambda path: np.savez(path, K=np.zeros((0, 0)), M=np.zeros((0, 0))), "the matrices have 0 rows"),
}


@pytest.mark.parametrize("fault", FILES)
def test_files_that_are_wrong_are_refused(tmp_path, fault):
    change, told = FILES[fault]
    made = stage(part_of(elastic(19), tmp_path))
    change(tmp_path / "body.npz")
    with pytest.raises(DesignError) as caught:
        superelement(made.parts["body"])
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("%%MatrixMarket matrix coordinate real symmetric\n12 12 1000000\n1 1 2.0\n", "truncated file"),
        ("%%MatrixMarket matrix coordinate complex general\n2 2 1\n1 1 2.0 1.0\n", "got complex"),
        ("%%MatrixMarket matrix array real general\n2 2\n1.0\nx\n3.0\n4.0\n", "cannot be read as a Matrix Market file"),
        ("no matrix", "cannot be read as a Matrix Market file"),
        ("%%MatrixMarket matrix coordinate real general\n100000000 100000000 1\n1 1 1.0\n", "got 100000000 x 100000000 with 1 entries"),
        ("%%MatrixMarket matrix coordinate real symmetric\n12 13 12\n1 1 2.0\n", "got 12 x 13 with 24 entries"),
    ],
)
def test_matrix_market_files_that_are_wrong_are_refused(tmp_path, text, told):
    for name in ("K", "M"):
        (tmp_path / f"{name}.mtx").write_text(text)
    part = Superelement(FileUnits.SI, elastic(0).ports, stiffness_file=str(tmp_path / "K.mtx"), mass_file=str(tmp_path / "M.mtx"))
    with pytest.raises(DesignError) as caught:
        superelement(part)
    assert told in str(caught.value)


def test_a_part_of_relative_files_has_absolute_paths(tmp_path, monkeypatch):
    body = elastic(3)
    given = written(body, tmp_path, "mtx")
    damping = damping_of(body, 25)
    scipy.io.mmwrite(tmp_path / "C.mtx", 0.5 * (damping + damping.T), symmetry="symmetric", precision=17)
    monkeypatch.chdir(tmp_path)
    made = superelement(replace(given, stiffness_file="K.mtx", mass_file="M.mtx", damping_file="C.mtx"))
    assert made.files == tuple(str(tmp_path / name) for name in ("K.mtx", "M.mtx", "C.mtx"))


def test_a_mass_matrix_of_another_size_is_refused_before_it_is_read(tmp_path):
    part = written(elastic(3), tmp_path, "mtx")
    (tmp_path / "M.mtx").write_text("%%MatrixMarket matrix coordinate real general\n100000000 100000000 1\n1 1 1.0\n")
    with pytest.raises(DesignError, match=r"got 100000000 x 100000000, expected .*, like the stiffness in K\.mtx"):
        matrix_file.read_matrices(replace(part, sha256=matrix_file.digest_of(part.files)))


def test_another_version_of_the_file_is_told(tmp_path):
    made = stage(part_of(elastic(21), tmp_path))
    assert not check(made)
    part_of(elastic(22), tmp_path)
    changed = replace(made, parts={"body": replace(made.parts["body"], loss_factor=0.02)})
    (told,) = check(changed)
    assert told.where == "parts.body.sha256"
    assert "wrong digest" in told.what


def test_links_name_a_body_for_every_port(tmp_path):
    made = stage(part_of(elastic(23), tmp_path))
    link = made.links["frame"]
    for joins in (("ground", "platform"), {"left": "ground", "right": "platform"}, {**link.joins, "bottom": "ground"}):
        told = check(replace(made, links={"frame": replace(link, joins=joins)}))
        assert any("expected left, right, top" in each.what for each in told)
    (told,) = check(replace(made, links={"frame": replace(link, bends=None)}))
    assert 'missing: part "body" has ports' in told.what
