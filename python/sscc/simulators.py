"""Models of bodies in simulators whose shapes are ``x = p + U q``.

The vertices of a model are all vertices of the body, with the simulator's numbers. Its faces are the body's surface.

- ``from_mujoco``: flexes of MuJoCo whose vertices are interpolated between nodes.
- ``from_simplicits``: bodies of Simplicits (NVIDIA Kaolin), moved by handles.
- ``from_sofa``: modes of SOFA's plugin ModelOrderReduction.

Only ``from_mujoco`` needs its simulator: the other functions take arrays, or files of numbers. All raise ValueError or TypeError
with a message that names the argument or the file; a file that cannot be read raises FileNotFoundError or OSError.
"""

from __future__ import annotations

import copy
import difflib
from collections.abc import Callable
from operator import index
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sscc._affine import affine_modes
from sscc._arrays import check_finite
from sscc._files import check_regular, escaped
from sscc._sscc import Model, _integers, _numbers
from sscc._text import quoted

__all__ = ["from_mujoco", "from_simplicits", "from_sofa"]

_F64 = NDArray[np.float64]


def from_mujoco(model: Any, flex: str | int) -> tuple[Model, Callable[[Any], _F64]]:
    """Returns the model of a flex with dof "trilinear" or "quadratic", and the function that maps MuJoCo's state to q.

    model: a ``mujoco.MjModel``; flex: its name or number. The state is a ``mujoco.MjData``.

    With ``body, q_of = from_mujoco(model, flex)``, ``body.positions(q_of(data))`` are the positions of the flex in
    ``data.flexvert_xpos``, except for rounding, after ``mj_forward`` or any other call that places the bodies. q has
    three numbers for each node, including pinned nodes: its displacement from its position at ``qpos0``. There are 24 numbers
    for "trilinear" and 81 for "quadratic", more with a ``cellcount``.

    Raises ImportError without the package mujoco.
    """
    try:
        import mujoco
    except ImportError as missing:
        message = "sscc.from_mujoco needs mujoco, which is not installed: pip install mujoco"
        raise ImportError(message) from missing
    if not isinstance(model, mujoco.MjModel):
        raise TypeError(f"model is a {type(model).__name__}: a mujoco.MjModel was expected")
    number, shown = _interpolated(model, flex)
    first = model.flex_nodeadr[number]
    nodes = slice(first, first + model.flex_nodenum[number])
    bodies, places = model.flex_nodebodyid[nodes].copy(), model.flex_node[nodes].copy()

    def node_positions(data: Any) -> _F64:
        turned = np.einsum("nij,nj->ni", data.xmat[bodies].reshape(-1, 3, 3), places)
        positions: _F64 = data.xpos[bodies] + turned
        return positions

    def q_of(data: Any) -> _F64:
        return (node_positions(data) - rest).ravel()

    at_rest = mujoco.MjData(model)
    mujoco.mj_kinematics(model, at_rest)
    rest = node_positions(at_rest)
    weights = _node_weights(model, number, nodes)
    return Model(weights @ rest, _flex_faces(model, number, shown), np.kron(weights, np.eye(3))), q_of


def from_simplicits(vertices: ArrayLike, faces: ArrayLike, weights: ArrayLike) -> Model:
    """Returns the model of a surface in a body of Simplicits, moved by H handles.

    vertices: (V, 3), at rest; faces: (F, 3); weights: (V, H), of the handles at the vertices, with any sign and sum.

    As in Kaolin's ``standard_lbs``, vertex x is moved by the sum of ``weights[h] * T[h] @ (x, 1)`` over h. The
    transforms T (H, 3, 4) are 0 at rest. q (12 H,) has their entries, row by row; in Kaolin it is
    ``scene.get_object_transforms(i)[:, :3].ravel()``, for weights that are not normalized.
    """
    x, w = _numbers(vertices, "vertices"), _numbers(weights, "weights")
    _check_points(x)
    if w.ndim != 2 or w.shape[0] != len(x) or w.shape[1] == 0:
        raise ValueError(f"weights has shape {list(w.shape)}: ({len(x)}, H) was expected, a row for each vertex")
    check_finite(w, "weights")
    return Model(x, faces, affine_modes(x, w))


def from_sofa(
    vertices: ArrayLike | str | PathLike[str],
    faces: ArrayLike,
    modes: ArrayLike | str | PathLike[str],
    rank: int | None = None,
) -> Model:
    """Returns the model of a body that SOFA's ``ModelOrderReductionMapping`` moves. q is the state of its input.

    vertices: (V, 3), the ``rest_position`` of its output, or a text file with three numbers in each line.
    faces: (F, 3), or tetrahedra (T, 4), whose boundary is used.
    modes: (3V, r), or the file at ``modesPath``: numbers of rows and columns in its first line, then the rows.
    rank: number of modes of the mapping, which are the first of ``modes``. None means all.

    A ``rotation`` of the mapping must be applied to the modes.
    """
    x = _matrix(vertices, "vertices", has_size=False)
    _check_points(x)
    u = _matrix(modes, "modes", has_size=True)
    if u.shape[:1] != (3 * len(x),) or u.ndim != 2:
        raise ValueError(f"modes has shape {list(u.shape)}: ({3 * len(x)}, r) was expected, 3 rows for each vertex")
    if rank is not None and not 1 <= rank <= u.shape[1]:
        raise ValueError(f"rank is {rank}: a number from 1 to {u.shape[1]} was expected, the columns of modes")
    return Model(x, _boundary(faces, len(x)), u[:, :rank])


def _interpolated(model: Any, flex: str | int) -> tuple[int, str]:
    """Returns the number of an interpolated flex, and its name for messages."""
    names = [model.names[start:].split(b"\0", 1)[0].decode() for start in model.name_flexadr]
    fit = ", ".join(quoted(names[i]) for i in np.flatnonzero(model.flex_interp))
    if isinstance(flex, str):
        if flex not in names:
            nearest = difflib.get_close_matches(flex, names, 1, 0)
            hint = f": the nearest name is {quoted(nearest[0])}" if nearest else ": the model has no flexes"
            raise ValueError(f"flex: no flex has the name {quoted(flex)}{hint}")
        number = names.index(flex)
    elif not hasattr(flex, "__index__"):
        raise TypeError(f"flex is a {type(flex).__name__}: a name or a number was expected")
    else:
        number = index(flex)
        if not 0 <= number < len(names):
            raise ValueError(f"flex is {number}: the model has {len(names)}, counted from 0")
    if not model.flex_interp[number]:
        raise ValueError(
            f"flex: {quoted(names[number])} is not interpolated, with dof 'trilinear' or 'quadratic'; "
            f"interpolated flexes: {fit or 'none'}"
        )
    return number, quoted(names[number])


def _node_weights(model: Any, flex: int, nodes: slice) -> _F64:
    """Returns the weight of each node at each vertex, (V, N).

    They are the positions that MuJoCo computes for the vertices when one node is at (1, 1, 1) and the others are at 0.
    So they equal MuJoCo's weights for any order, any cells and any version.
    """
    import mujoco

    probe = copy.copy(model)
    probe.flex_centered[flex] = False
    data = mujoco.MjData(probe)
    data.xpos[:], data.xmat[:] = 0, np.eye(3).ravel()
    first = model.flex_vertadr[flex]
    vertices = slice(first, first + model.flex_vertnum[flex])
    weights = np.empty((model.flex_vertnum[flex], model.flex_nodenum[flex]))
    for column, node in enumerate(range(nodes.start, nodes.stop)):
        probe.flex_node[nodes] = 0
        probe.flex_node[node] = 1
        mujoco.mj_flex(probe, data)
        weights[:, column] = data.flexvert_xpos[vertices, 0]
    return weights


def _flex_faces(model: Any, flex: int, shown: str) -> NDArray[np.int32]:
    """Returns the triangles of a flex, or the boundary of its tetrahedra."""
    if model.flex_dim[flex] == 2:
        first, count, corners = model.flex_elemdataadr[flex], model.flex_elemnum[flex], model.flex_elem
    elif model.flex_dim[flex] == 3:
        first, count, corners = model.flex_shelldataadr[flex], model.flex_shellnum[flex], model.flex_shell
    else:
        raise ValueError(f"flex: {shown} has dim {model.flex_dim[flex]}: 2 or 3 was expected, for a surface")
    faces: NDArray[np.int32] = corners[first : first + 3 * count].reshape(-1, 3)
    return faces


def _boundary(faces: ArrayLike, vertices: int) -> NDArray[np.int64]:
    """Returns triangles unchanged, and for tetrahedra the triangles that belong to only one tetrahedron."""
    cells = _integers(faces, "faces")
    if cells.ndim != 2 or cells.shape[1] != 4:
        return cells
    outside = ((cells < 0) | (cells >= vertices)).any(axis=1)
    if outside.any():
        cell = int(np.argmax(outside))
        raise ValueError(f"faces[{cell}] is {cells[cell].tolist()}: vertices has {vertices}, counted from 0")
    triangles = cells[:, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]].reshape(-1, 3)
    _, firsts, counts = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True)
    boundary: NDArray[np.int64] = triangles[np.sort(firsts[counts == 1])]
    return boundary


def _check_points(x: _F64) -> None:
    if x.ndim != 2 or x.shape[1] != 3:
        raise ValueError(f"vertices has shape {list(x.shape)}: (V, 3) was expected")


def _number(word: str) -> float:
    """Returns the number that a word of a text file states."""
    # Python also reads "1_0" as 10, and the digits of other scripts.
    if "_" in word or not word.isascii():
        raise ValueError(word)
    return float(word)


def _matrix(given: ArrayLike | str | PathLike[str], name: str, *, has_size: bool) -> _F64:
    """Returns the numbers of an array, or of a text file with a row in each line.

    In a file that ``has_size``, line 1 has the numbers of rows and columns.
    """
    if not isinstance(given, str | PathLike):
        return _numbers(given, name)
    check_regular(given)
    place = escaped(given)
    rows: list[list[float]] = []
    for number, line in enumerate(Path(given).read_text(errors="replace").rstrip().splitlines(), 1):
        try:
            row = [_number(word) for word in line.split()]
        except ValueError:
            raise ValueError(f"{place}: line {number}: numbers were expected") from None
        if number > 1 + has_size and len(row) != len(rows[-1]):
            raise ValueError(f"{place}: line {number} has {len(row)} numbers: {len(rows[-1])} were expected")
        rows.append(row)
    size = rows.pop(0) if has_size and rows else None
    if not rows:
        raise ValueError(f"{place}: the file has no rows of numbers")
    matrix = np.array(rows)
    if size is None:
        return matrix
    if len(size) != 2 or size[0] != len(rows) or size[1] not in range(1, matrix.shape[1] + 1):
        raise ValueError(f"{place}: line 1: '{len(rows)} {matrix.shape[1]}' was expected, the size of the matrix")
    # SOFA ignores further columns, which its own files may have.
    return matrix[:, : int(size[1])]
