from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from typing import Any, Literal, SupportsIndex, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | PathLike[str]
_Progress = Callable[[float], object] | bool | None
_Metric = Literal["energy", "displacement", "mass", "identity"] | ArrayLike
_Bool = NDArray[np.bool_]
_I32 = NDArray[np.int32]
_I64 = NDArray[np.int64]
_U32 = NDArray[np.uint32]
_U64 = NDArray[np.uint64]
_F64 = NDArray[np.float64]

@final
class Model:
    """A triangle mesh and its deformation modes: at q the shape is ``x = p + U q``.

    Arrays may have any memory order and byte order, and be of float64, float32 or integers; lists of numbers do, too.
    NaN, infinities, masked arrays and other types are refused.

    vertices: (V, 3), rest positions p in any unit of length.
    faces: (F, 3) integers, vertex numbers counted from 0.
    modes: U as (3V, r), (V, 3, r) or (r, V, 3): the displacement of each vertex for a unit of each entry of q.
    metric: how modes weigh in ``norm``: a name, weights (r,) or a matrix (r, r); None: "displacement".

    Raises TypeError or ValueError, whose message names the argument and the row.
    """

    def __new__(
        cls, vertices: ArrayLike, faces: ArrayLike, modes: ArrayLike, metric: _Metric | None = None
    ) -> Model: ...
    @classmethod
    def load(cls, path: _Path, modes: _Path | None = None, *, mesh_name: str | None = None) -> Model:
        """Reads ``*.model.safetensors``, ``.glb`` or ``.gltf`` with morph targets, a complete ``.npz``, or a mesh (OBJ,
        PLY, OFF, STL) with its ``modes`` (``.npy``, ``.npz``, VegaFEM's matrices, a folder of target meshes).

        ``mesh_name`` chooses one of several meshes of a glTF file. Raises FileNotFoundError, OSError, ValueError.
        """
    def save(self, path: _Path) -> None:
        """Writes ``*.model.safetensors``, whole or not at all."""
    def certify(
        self,
        *,
        epsilon: float | None = None,
        metric: _Metric | None = None,
        center: ArrayLike | None = None,
        scheme: Literal["full", "paper"] | None = None,
        budget: int | None = None,
        neighbours: Literal["exclude", "include-one-vertex"] | None = None,
        weld: bool | None = None,
        ignore_rest: bool | None = None,
        max_exceptions: int | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Certificates:
        """Computes certificates: once for a model. The same for any number of ``threads`` (None: all cores).

        epsilon: relative error allowed of the root's radius (0.1).
        metric: as of the model; None: the model's own.
        center: the q about which radii are measured (r,); None: 0, the rest pose.
        scheme: "full" (default) stores pairs of nodes, too, ``budget`` (16) bytes for each triangle; "paper" does not.
        neighbours: whether triangles that share exactly one vertex count where they meet beside it.
        weld: whether vertices of equal position and modes are one, for adjacency; None: STL and glTF files.
        ignore_rest: pairs that collide at rest are left out for good.
        max_exceptions: how many pairs that collide at the centre may be tested in every query; None: F / 2.
        progress: a function that is called with the share done, from 0 to 1; True: a bar on standard error; False:
            nothing; None: a bar in a terminal or notebook. What the function raises stops the work.
        """
    def positions(self, q: ArrayLike) -> _F64:
        """The vertices at q, (V, 3): exactly the shape that all answers speak of."""
    @property
    def vertices(self) -> _F64:
        """Rest positions, (V, 3); a copy."""
    @property
    def faces(self) -> _U32:
        """Vertex numbers, (F, 3); a copy."""
    @property
    def modes(self) -> _F64:
        """U, (V, 3, r); a copy. ``modes.reshape(-1, r)`` is the matrix."""
    @property
    def rank(self) -> int:
        """Number of modes r."""
    @property
    def metric(self) -> str:
        """The name of the default metric: energy, displacement, mass, identity or given."""
    @property
    def metric_factor(self) -> _F64:
        """The factor S of ``norm = |S q|``: its diagonal (r,), or S itself (r, r)."""
    @property
    def units(self) -> str:
        """The unit of length, or empty."""
    @property
    def provenance(self) -> str:
        """Where mesh and modes come from, or empty."""
    @property
    def mode_names(self) -> list[str]:
        """Names of the modes (r), such as those of morph targets, or none."""
    @property
    def default_q(self) -> _F64:
        """The q that a glTF file shows when nothing moves it (r,), else 0."""
    @property
    def stiffness(self) -> _F64 | None:
        """The reduced stiffness at rest (r, r), where it is known."""

@final
class Certificates:
    """What is proven of a model. Use it from any number of threads at once.

    All radii and norms are lengths ``|S (q - center)|`` in the metric of the certificates.
    """

    @classmethod
    def load(cls, path: _Path, model: Model) -> Certificates:
        """Reads ``*.sscc.safetensors``; refuses certificates of another model (ValueError)."""
    def save(self, path: _Path) -> None:
        """Writes ``*.sscc.safetensors``, whole or not at all."""
    def check(self, q: ArrayLike, limit: SupportsIndex | None = None) -> Answer:
        """Which pairs of triangles intersect or touch at q (r,). With ``limit`` at most so many; which is not fixed."""
    def check_many(
        self,
        Q: ArrayLike,
        limit: SupportsIndex | None = None,
        *,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Batch:
        """``check`` for every row of Q (n, r), on so many threads (None: all cores). Q is read where it is: do not
        write to it meanwhile."""
    def continuous(self, q0: ArrayLike, q1: ArrayLike) -> Impacts:
        """Which pairs meet while every vertex moves on a straight line from its place at q0 to that at q1, and when.

        None is missed, and no time is later than the true one; a pair listed without need has come within 1e-12 of its
        size.
        """
    def safe_scale(self, q: ArrayLike) -> float:
        """A scale s: the shape is proven free on the whole way from the centre to ``center + s (q - center)``."""
    def clamp(self, q: ArrayLike) -> _F64 | None:
        """q, or the last point on the way from the centre to q that is free by the root's certificate. None where
        that proves nothing: its radius is 0, or there are exceptions."""
    def norm(self, q: ArrayLike) -> float:
        """``|S (q - center)|``, rounded up."""
    def radius(self, node: SupportsIndex) -> float:
        """Below this norm no two triangles of the node meet, exceptions apart."""
    def kinetic(self) -> KineticQuery:
        """A query for the small steps of one simulation."""
    @property
    def model(self) -> Model: ...
    @property
    def root_radius(self) -> float:
        """Below this norm the whole shape is free, exceptions apart."""
    @property
    def global_radius(self) -> float:
        """Up to here radii are resolved; may be infinite."""
    @property
    def epsilon(self) -> float: ...
    @property
    def metric(self) -> str: ...
    @property
    def metric_factor(self) -> _F64:
        """The factor S: its diagonal (r,), or S itself (r, r)."""
    @property
    def center(self) -> _F64:
        """(r,)"""
    @property
    def neighbours(self) -> str: ...
    @property
    def weld(self) -> bool: ...
    @property
    def ignored(self) -> _U32:
        """Pairs that never count, (n, 2)."""
    @property
    def exceptions(self) -> _U32:
        """Pairs that collide at the centre: no radius speaks of them, every query tests them. (n, 2)"""
    @property
    def rest_collisions(self) -> int:
        """Number of pairs that collide at rest, ignored ones included."""
    @property
    def nodes(self) -> int:
        """Number of nodes of the hierarchy."""
    @property
    def pairs(self) -> int:
        """Number of pairs of nodes whose radii are stored."""
    @property
    def pair_limit(self) -> float:
        """Up to this norm the pairs of nodes are complete; 0 without any."""
    @property
    def digest(self) -> str:
        """BLAKE3 of all that the certificates speak of, in hexadecimal."""
    @property
    def hierarchy(self) -> Hierarchy: ...

@final
class Hierarchy:
    """The tree over the triangles. Node n holds ``order[first[n]:first[n] + count[n]]``; node 0 is the root."""

    @property
    def parent(self) -> _I32:
        """The parent of each node, -1 for the root."""
    @property
    def level(self) -> _I32:
        """The level of each node, 0 for the root."""
    @property
    def first(self) -> _U32: ...
    @property
    def count(self) -> _U32: ...
    @property
    def order(self) -> _U32: ...
    @property
    def radius(self) -> _F64:
        """The radius of each node, see ``Certificates.radius``."""
    def __len__(self) -> int: ...

@final
class KineticQuery:
    """``check`` for a q that changes little from call to call: the same answers, at less cost. One caller at a time;
    others wait."""

    def check(self, q: ArrayLike) -> Answer: ...

@final
class Answer:
    """What was found at one q. Not true or false by itself: ask for ``colliding``."""

    @property
    def pairs(self) -> _U32:
        """Colliding pairs (i, j), i < j, sorted: (n, 2), read-only."""
    @property
    def colliding(self) -> bool:
        """Whether any pair collides; False is a proof."""
    @property
    def count(self) -> int:
        """Number of pairs; a lower bound where not ``complete``."""
    @property
    def norm(self) -> float:
        """``|S (q - center)|``, rounded up."""
    @property
    def complete(self) -> bool:
        """Whether the pairs are all; False where ``limit`` stopped the search."""
    @property
    def root_certified(self) -> bool:
        """Whether one comparison was the proof, exceptions apart."""
    @property
    def opened(self) -> int:
        """Nodes and pairs of nodes that had to be opened."""
    @property
    def box_tests(self) -> int: ...
    @property
    def triangle_tests(self) -> int: ...

@final
class Impacts:
    """What meets on the way from one q to another. Not true or false by itself: ask for ``colliding``."""

    @property
    def pairs(self) -> _U32:
        """Pairs that meet, sorted: (n, 2), read-only."""
    @property
    def times(self) -> _F64:
        """When each does, from 0 to 1, never later than the true time: (n,), read-only."""
    @property
    def time_of_impact(self) -> float | None:
        """The earliest time; the shape is free before. None: free on the whole way."""
    @property
    def colliding(self) -> bool: ...
    @property
    def count(self) -> int: ...
    @property
    def norm(self) -> float:
        """The larger one of both ends."""
    @property
    def complete(self) -> bool: ...
    @property
    def root_certified(self) -> bool: ...
    @property
    def opened(self) -> int: ...
    @property
    def box_tests(self) -> int: ...
    @property
    def triangle_tests(self) -> int: ...

@final
class Batch:
    """The answers to n configurations: arrays with one entry for each (read-only), and ``batch[i]``, an Answer."""

    @property
    def colliding(self) -> _Bool: ...
    @property
    def count(self) -> _I64: ...
    @property
    def norm(self) -> _F64: ...
    @property
    def complete(self) -> _Bool: ...
    @property
    def root_certified(self) -> _Bool: ...
    @property
    def opened(self) -> _U64: ...
    @property
    def triangle_tests(self) -> _U64: ...
    @property
    def pairs(self) -> _U32:
        """The pairs of all answers, one after the other: (m, 2)."""
    @property
    def offsets(self) -> _I64:
        """(n + 1,): those of answer i are ``pairs[offsets[i]:offsets[i + 1]]``."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex, /) -> Answer: ...
    def __iter__(self) -> Iterator[Answer]: ...

def _core_seconds(
    certificates: Certificates, Q: ArrayLike, threads: int | None, one_by_one: bool = True
) -> tuple[float, list[float]]: ...
def _elastic(
    source: object,
    kind: Literal["linear", "nonlinear", "polynomial"],
    rank: int | None,
    fix: ArrayLike | None,
    fix_box: ArrayLike | None,
    material: tuple[float | None, float | None, float | None],
    resolution: int | None,
    threads: int | None,
    progress: _Progress,
) -> Model: ...
def _polynomial(source: object, threads: int | None, progress: _Progress) -> Model: ...
def _pca(
    shapes: object, faces: ArrayLike | None, rank: int | None, threads: int | None, progress: _Progress
) -> Model: ...
def _simulate(
    scene: _Path,
    out: _Path | None,
    steps: int | None,
    restart: bool | None,
    models: _Path | None,
    cache: _Path | None,
    threads: int | None,
) -> tuple[str, str, list[str]]: ...

# For sscc.batch.

def _certificates(bytes: bytes, model: Model) -> Certificates: ...

@final
class _ShardWorker:
    def __new__(cls, model: Model, typed: dict[str, Any]) -> _ShardWorker: ...
    def run(self, job: bytes) -> bytes: ...

def _build() -> str: ...
def _certify_in_shards(
    model: Model, typed: dict[str, Any], shards: int, run: Callable[[list[bytes], float], list[bytes]]
) -> Certificates: ...
def _check_options(model: Model | None, typed: dict[str, Any]) -> None: ...
def _configurations(certificates: Certificates, Q: ArrayLike) -> _F64: ...
def _joined(batches: list[Batch]) -> Batch: ...
