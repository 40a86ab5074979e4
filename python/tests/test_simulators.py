"""Models of bodies in simulators: their positions and pairs are those of the simulator."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import sscc
from conftest import needs
from shapes import samples, torus
from test_arrays import OnlyDlpack

F64 = NDArray[np.float64]


def text(array: Any) -> str:
    return " ".join(map(repr, array.ravel().tolist()))


V, F, _ = torus(16, 8, 1)

#: The scene has a block with two pinned nodes in a body that moves, a ring, a bar of six cells, a shell whose inner node
#: follows the others, a net whose vertices are bodies, and a rope.
SCENE = f"""
<mujoco><worldbody>
  <body name="base" pos=".1 .2 .3" euler="10 20 30">
    <freejoint/>
    <geom size=".01"/>
    <flexcomp name="block" type="grid" dim="3" count="5 4 4" spacing=".2 .2 .2" radius=".001" dof="trilinear" mass="1">
      <pin id="0 3"/>
    </flexcomp>
  </body>
  <flexcomp name="ring" type="direct" dim="2" point="{text(V)}" element="{text(F)}" radius=".001"
            dof="quadratic" mass="1"/>
  <flexcomp name="bar" type="grid" dim="3" count="7 3 3" spacing=".1 .1 .1" radius=".001" dof="quadratic" cellcount="3 1 2"
            mass="1"/>
  <flexcomp name="shell" type="box" dim="2" count="4 4 4" spacing=".1 .1 .1" radius=".001" dof="quadratic" mass="1">
    <elasticity young="1e4" poisson=".2" elastic2d="both" thickness=".01"/>
  </flexcomp>
  <flexcomp name="net" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" radius=".001" mass="1"/>
  <flexcomp name="rope" type="direct" dim="1" point="0 0 0 .1 0 .1 .1 .1 0" element="0 1 1 2" radius=".001"
            dof="trilinear" mass="1"/>
</worldbody></mujoco>"""
BLOCK, RING, BAR, SHELL = range(4)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Changes the current folder, to which MuJoCo writes its warnings."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def scene(request: pytest.FixtureRequest) -> Any:
    """A ``mujoco.MjModel``."""
    needs(request, "mujoco")
    import mujoco

    return mujoco.MjModel.from_xml_string(SCENE)


def states(scene: Any, flex: int, count: int, scale: float) -> Iterator[tuple[Any, F64]]:
    """Returns random states of a scene, and the positions (V, 3) of a flex in each of them."""
    import mujoco

    data = mujoco.MjData(scene)
    vertices = slice(scene.flex_vertadr[flex], scene.flex_vertadr[flex] + scene.flex_vertnum[flex])
    for change in samples(count, scene.nq, scale):
        data.qpos[:] = scene.qpos0 + change
        mujoco.mj_kinematics(scene, data)
        mujoco.mj_comPos(scene, data)
        mujoco.mj_flex(scene, data)
        yield data, data.flexvert_xpos[vertices].copy()


@pytest.mark.parametrize("name, flex, rank, scale", [("block", BLOCK, 24, 0.2), ("ring", RING, 81, 0.15)])
def test_a_thousand_states_of_a_flex(scene: Any, name: str, flex: int, rank: int, scale: float) -> None:
    model, q_of = sscc.from_mujoco(scene, name)
    assert model.rank == rank and len(model.vertices) == scene.flex_vertnum[flex]
    certs = model.certify(scheme="paper")
    tolerance = 4 * np.spacing(np.linalg.norm(np.ptp(model.vertices, axis=0)))
    colliding, worst = 0, 0
    for data, x in states(scene, flex, 1000, scale):
        q = q_of(data)
        worst = max(worst, abs(model.positions(q) - x).max())
        pairs = certs.check(q).pairs
        assert np.array_equal(pairs, sscc.self_intersections(x, model.faces))
        colliding += len(pairs) > 0
    assert worst <= tolerance
    assert 100 < colliding < 1000


@pytest.mark.parametrize("flex, rank", [(BAR, 3 * 7 * 3 * 5), (SHELL, 81)])
def test_flexes_with_cells_and_shells_have_the_positions_of_mujoco(scene: Any, flex: int, rank: int) -> None:
    model, q_of = sscc.from_mujoco(scene, flex)
    assert model.rank == rank
    for data, x in states(scene, flex, 10, 0.1):
        assert np.allclose(model.positions(q_of(data)), x, rtol=0, atol=1e-14)


def test_the_surface_of_a_flex(scene: Any) -> None:
    import mujoco

    for name in ("block", "ring"):
        model, q_of = sscc.from_mujoco(scene, name)
        edges = np.sort(model.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()  # closed
        data = mujoco.MjData(scene)
        mujoco.mj_forward(scene, data)
        assert not q_of(data).any()
        assert not model.certify().check(q_of(data)).colliding
    assert np.array_equal(model.faces, F)


@pytest.mark.usefixtures("mujoco")
def test_a_body_that_moves_and_turns_is_proven_free() -> None:
    import mujoco

    flex = 'name="cube" type="grid" dim="3" count="15 15 15" spacing=".1 .1 .1" radius=".001" dof="trilinear" mass="1"'
    scene = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody><flexcomp {flex}/></worldbody></mujoco>")
    model, q_of = sscc.from_mujoco(scene, "cube")
    data = mujoco.MjData(scene)
    mujoco.mj_kinematics(scene, data)
    certs = model.certify()
    for angle in (0.1, 1, 3):
        cos, sin = np.cos(angle), np.sin(angle)
        moved = mujoco.MjData(scene)
        moved.xpos[:] = data.xpos @ [[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]] + [5, 0, 0]
        answer = certs.check(q_of(moved))
        assert not answer.colliding and answer.proof == "local"


FLEXES: list[tuple[Any, type[Exception], str]] = [
    (
        "net",
        ValueError,
        "flex: 'net' is not interpolated, with dof 'trilinear' or 'quadratic'; "
        "interpolated flexes: 'block', 'ring', 'bar', 'shell', 'rope'",
    ),
    (4, ValueError, "flex: 'net' is not interpolated"),
    ("rnig", ValueError, "flex: no flex has the name 'rnig': the nearest name is 'ring'"),
    (6, ValueError, "flex is 6: the model has 6, counted from 0"),
    (-1, ValueError, "flex is -1: the model has 6"),
    (None, TypeError, "flex is a NoneType: a name or a number was expected"),
    ("rope", ValueError, "flex: 'rope' has dim 1: 2 or 3 was expected, for a surface"),
]


@pytest.mark.parametrize("flex, kind, message", FLEXES)
def test_refused_flexes(scene: Any, flex: Any, kind: type[Exception], message: str) -> None:
    refused(kind, message, lambda: sscc.from_mujoco(scene, flex))


def test_refused_models_and_states(scene: Any) -> None:
    import mujoco

    refused(TypeError, "model is a str: a mujoco.MjModel was expected", lambda: sscc.from_mujoco(SCENE, "block"))
    empty = mujoco.MjModel.from_xml_string("<mujoco/>")
    refused(ValueError, "flex: no flex has the name 'block': the model has no flexes", lambda: sscc.from_mujoco(empty, "block"))
    model, q_of = sscc.from_mujoco(scene, "block")
    data = mujoco.MjData(scene)
    mujoco.mj_kinematics(scene, data)
    data.xpos[scene.flex_nodebodyid[1]] = np.nan
    refused(ValueError, "q[3] is NaN: every entry must be finite", lambda: model.positions(q_of(data)))


def test_without_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    message = "sscc.from_mujoco needs mujoco, which is not installed: pip install mujoco"
    refused(ImportError, message, lambda: sscc.from_mujoco(SCENE, "block"))


def test_simplicits() -> None:
    random = np.random.default_rng(4)
    weights = random.normal(size=(len(V), 5))
    others: Any = OnlyDlpack(weights)
    model = sscc.from_simplicits(V, F, others)
    assert model.rank == 60 and np.array_equal(model.vertices, V) and np.array_equal(model.faces, F)
    homogeneous = np.concatenate([V, np.ones((len(V), 1))], axis=1)
    certs = model.certify(scheme="paper")
    for transforms in 0.05 * random.normal(size=(50, 5, 3, 4)):
        x = V + np.einsum("vh,hij,vj->vi", weights, transforms, homogeneous)
        assert np.allclose(model.positions(transforms.ravel()), x, rtol=0, atol=1e-14)
        assert np.array_equal(certs.check(transforms.ravel()).pairs, sscc.self_intersections(x, F))


W = np.ones((len(V), 2))

SIMPLICITS: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"vertices": V[:, :2]}, ValueError, "vertices has shape [128, 2]: (V, 3) was expected"),
    ({"vertices": V * np.nan}, ValueError, "vertices: vertex 0 (counted from 0) has the position"),
    ({"faces": F[:, :2]}, ValueError, "faces has shape [256, 2]: (F, 3) was expected"),
    ({"weights": W.T}, ValueError, "weights has shape [2, 128]: (128, H) was expected, a row for each vertex"),
    ({"weights": W[:, :0]}, ValueError, "weights has shape [128, 0]: (128, H) was expected"),
    ({"weights": np.where(np.eye(128, 2), np.nan, W)}, ValueError, "weights[0, 0] is nan: every entry must be finite"),
    ({"weights": "many"}, TypeError, "weights is a str: an array of numbers was expected"),
    ({"weights": [np.ma.masked_array(row) for row in W]}, TypeError, "weights is a masked array: fill it first"),
]


@pytest.mark.parametrize("changed, kind, message", SIMPLICITS)
def test_refused_arguments_of_simplicits(changed: dict[str, Any], kind: type[Exception], message: str) -> None:
    refused(kind, message, lambda: sscc.from_simplicits(**{"vertices": V, "faces": F, "weights": W, **changed}))


#: A cube of six tetrahedra around a diagonal. Each has another order of its corners.
CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
TETRAHEDRA = np.array([[0, 4, 6, 7], [4, 0, 5, 7], [0, 1, 7, 5], [1, 3, 0, 7], [0, 2, 3, 7], [2, 6, 7, 0]])
MODES = samples(24, 4, 0.3)


def modes_file(folder: Path, modes: F64) -> Path:
    path = folder / "modes.txt"
    rows = "".join(" ".join(map(repr, row)) + "\n" for row in modes.tolist())
    path.write_text(f"{modes.shape[0]} {modes.shape[1]}\n{rows}")
    return path


def test_sofa(tmp_path: Path) -> None:
    model = sscc.from_sofa(CUBE, TETRAHEDRA, MODES)
    assert model.rank == 4 and np.array_equal(model.modes.reshape(24, 4), MODES)
    corners = CUBE[model.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Each of the six sides has two triangles.
    assert np.unique(np.abs(normals), axis=0, return_counts=True)[1].tolist() == [4, 4, 4]
    assert (np.linalg.norm(normals, axis=1) == 1).all()
    for q in samples(20, 4, 1):
        assert np.allclose(model.positions(q), CUBE + (MODES @ q).reshape(-1, 3), rtol=0, atol=1e-15)

    points = tmp_path / "rest.txt"
    points.write_text("".join(f"{x} {y} {z}\n" for x, y, z in CUBE.tolist()) + "\n")
    read = sscc.from_sofa(str(points), model.faces, modes_file(tmp_path, MODES), 3)
    assert np.array_equal(read.vertices, CUBE) and np.array_equal(read.faces, model.faces)
    assert np.array_equal(read.modes, model.modes[:, :, :3])
    wide = tmp_path / "modes.txt"
    wide.write_text(wide.read_text().replace("24 4", "24 2", 1))
    assert np.array_equal(sscc.from_sofa(CUBE, TETRAHEDRA, wide).modes, model.modes[:, :, :2])


SOFA: list[tuple[dict[str, Any], type[Exception], str]] = [
    ({"vertices": CUBE.T}, ValueError, "vertices has shape [3, 8]: (V, 3) was expected"),
    ({"faces": TETRAHEDRA + 1}, ValueError, "faces[0] is [1, 5, 7, 8]: vertices has 8, counted from 0"),
    ({"faces": TETRAHEDRA - 1}, ValueError, "faces[0] is [-1, 3, 5, 6]: vertices has 8, counted from 0"),
    ({"faces": TETRAHEDRA[:, :2]}, ValueError, "faces has shape [6, 2]: (F, 3) was expected"),
    ({"faces": TETRAHEDRA / 2}, TypeError, "faces is an array of float64: integers were expected"),
    ({"faces": np.ma.masked_array(TETRAHEDRA)}, TypeError, "faces is a masked array: fill it first"),
    ({"modes": np.full((24, 1), 2**53 + 1)}, ValueError, "modes: the integer 9007199254740993 is beyond 2^53"),
    ({"modes": MODES[:-1]}, ValueError, "modes has shape [23, 4]: (24, r) was expected, 3 rows for each vertex"),
    ({"modes": MODES.ravel()}, ValueError, "modes has shape [96]: (24, r) was expected"),
    ({"modes": MODES * np.nan}, ValueError, "modes: mode 0 of vertex 0 (both counted from 0)"),
    ({"rank": 5}, ValueError, "rank is 5: a number from 1 to 4 was expected, the columns of modes"),
    ({"rank": 0}, ValueError, "rank is 0: a number from 1 to 4 was expected"),
]


@pytest.mark.parametrize("changed, kind, message", SOFA)
def test_refused_arguments_of_sofa(changed: dict[str, Any], kind: type[Exception], message: str) -> None:
    refused(kind, message, lambda: sscc.from_sofa(**{"vertices": CUBE, "faces": TETRAHEDRA, "modes": MODES, **changed}))


FILES = [
    ("", "the file has no rows of numbers"),
    ("24 4\n", "the file has no rows of numbers"),
    ("1 2\n1 x\n", "line 2: numbers were expected"),
    ("2 2\n1 2\n3\n", "line 3 has 1 numbers: 2 were expected"),
    ("3 2\n1 2\n3 4\n", "line 1: '2 2' was expected, the size of the matrix"),
    ("1 3\n1 2\n", "line 1: '1 2' was expected, the size of the matrix"),
    ("1 1.5\n1 2\n", "line 1: '1 2' was expected, the size of the matrix"),
    ("1 2 3\n1 2 3\n", "line 1: '1 3' was expected, the size of the matrix"),
    ("1 2\n1_0 2\n", "line 2: numbers were expected"),
    ("\0\xff", "line 1: numbers were expected"),
]


@pytest.mark.parametrize("content, message", FILES)
def test_refused_files_of_modes(tmp_path: Path, content: str, message: str) -> None:
    path = tmp_path / "modes.txt"
    path.write_text(content, encoding="latin-1")
    refused(ValueError, f"{path}: {message}", lambda: sscc.from_sofa(CUBE, TETRAHEDRA, path))
    with pytest.raises(FileNotFoundError):
        sscc.from_sofa(CUBE, TETRAHEDRA, tmp_path / "no.txt")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
def test_folders_pipes_and_devices_are_refused(tmp_path: Path) -> None:
    pipe, device = tmp_path / "pipe\n.txt", Path("/dev/zero")
    os.mkfifo(pipe)
    for path, shown, found in [
        (tmp_path, str(tmp_path), "a directory"),
        (pipe, f"{tmp_path}/pipe\\n.txt", "a device or pipe"),
        (device, "/dev/zero", "a device or pipe"),
    ]:
        refused(OSError, f"{shown}: is {found}, a file was expected", lambda: sscc.from_sofa(CUBE, TETRAHEDRA, path))


@pytest.mark.skipif(os.name == "nt", reason="names of files cannot have line breaks")
def test_paths_in_messages_are_on_one_line(tmp_path: Path) -> None:
    path = tmp_path / "a\nb.txt"
    path.write_text("1 2\n1 x\n")
    message = f"{tmp_path}/a\\nb.txt: line 2: numbers were expected"
    refused(ValueError, message, lambda: sscc.from_sofa(CUBE, TETRAHEDRA, path))


def refused(kind: type[Exception], message: str, call: Callable[[], Any]) -> None:
    with pytest.raises(kind, match=f"^{re.escape(message)}") as error:
        call()
    assert "\n" not in str(error.value)
