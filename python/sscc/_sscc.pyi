from collections.abc import Callable, Iterator, Sequence
from os import PathLike
from typing import Any, Literal, SupportsIndex, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sscc._curve import Curve
from sscc._penetration import BodyPenetration
from sscc._resolve import FreeSamples, Resolved
from sscc._scene import SceneAnswer
from sscc._sweep import Intervals, Sweep

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
_Str = NDArray[np.str_]

@final
class Model:
    """A triangle mesh and its deformation modes: at q the shape is ``x = p + U q``.

    Arrays are float64, float32, float16 or integers, in any memory and byte order, or lists of numbers. They are
    copied. NaN, infinities, masked arrays and other types are refused.

    vertices: (V, 3), rest positions p in any unit of length.
    faces: (F, 3) integers, vertex numbers counted from 0.
    modes: U as (3V, r), (V, 3, r), (r, V, 3), or (V, 3) for one mode: the displacement of each vertex for a unit of
        each entry of q.
    metric: the matrix M of the norm ``sqrt(q'Mq)``: a name, its diagonal (r,) or the full matrix (r, r). None means
        "displacement".

    Raises TypeError or ValueError; the message names the argument and the row.
    """

    def __new__(
        cls, vertices: ArrayLike, faces: ArrayLike, modes: ArrayLike, metric: _Metric | None = None
    ) -> Model: ...
    @classmethod
    def load(cls, path: _Path, modes: _Path | None = None, *, mesh_name: str | None = None) -> Model:
        """Reads ``*.model.safetensors``, ``.glb``, ``.gltf`` or ``.vrm`` with morph targets, a complete ``.npz``, or a
        mesh (OBJ, PLY, OFF, STL) with its ``modes`` (``.npy``, ``.npz``, VegaFEM's matrices, a folder of target meshes).

        ``mesh_name``, or ``FILE#NAME`` as the path, chooses one of several meshes of a glTF file. The model is in the
        coordinates of its mesh: nodes do not move it. Primitives that lack some morph targets cause a warning. Raises
        FileNotFoundError, OSError, ValueError.
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
        local_budget: int | None = None,
        reach: float | None = None,
        neighbours: Literal["exclude", "include-one-vertex"] | None = None,
        weld: bool | None = None,
        ignore_rest: bool | int | None = None,
        max_exceptions: int | None = None,
        clearance: float | None = None,
        rings: SupportsIndex | None = None,
        groups: ArrayLike | None = None,
        ignore_groups: ArrayLike | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Certificates:
        """Computes certificates, once for a model.

        epsilon: allowed relative error of the root's radius. None means 0.1.
        metric: as in ``Model``. None means the model's own metric.
        center: the q from which radii are measured (r,). None means 0, the rest pose.
        scheme: "full" (default) stores a pair tree of up to ``budget`` (64) bytes for each triangle,
            and local certificates; "paper" does not.
        local_budget: bytes for each triangle that local certificates may take, in addition to the unused part of ``budget``.
            With 0 there are none. None means 64.
        reach: maximum radius of the scheme "full", in units of the paper's global radius. None means 1.
        neighbours: "include-one-vertex": triangles that share one vertex count if they have another common point.
        weld: whether vertices of equal position and modes are one, for adjacency. None means only for STL and glTF files.
        ignore_rest: True: pairs that collide at rest never count. A number: in addition, pairs within this number of rings of
            them never count.
        max_exceptions: largest number of pairs that collide at the centre and are tested in every query. None means F / 2,
            rounded up.
        clearance: for ``within``. Radii are then those at which triangles come nearer than this, instead of those at which they
            collide; other queries are answered without certificates. ``rings``: triangles within this number of rings of each
            other on the surface do not count. None means 1.
        groups: the group of each triangle (F,), from 0 to 65535. None means no groups.
        ignore_groups: pairs of groups (n, 2): triangles of these two groups do not count. A pair (a, a) ignores pairs within
            group a.
        threads: the number of threads, from 1 to 1024. None means all cores. The certificates do not depend on it.
        progress: a function that receives the finished share, from 0 to 1; its exceptions stop the work. The share ascends, and is
            1 only at the end of work without an error. True shows a bar on standard error, False nothing. None means a bar on a
            terminal or in a notebook.
        """
    def positions(self, q: ArrayLike) -> _F64:
        """Returns the vertices at q, (V, 3): the positions that all queries test."""
    def static(self, forces: ArrayLike, *, gravity: ArrayLike | None = None) -> _F64:
        """Returns the q (r,) of forces on the vertices, (V, 3): the linear static solution in the span of the modes.

        forces: in newtons, for a model in metres.
        gravity: acceleration (3,) of the whole mass, in m/s^2. Raises ValueError for models without stiffness, or for gravity
            without mass.
        """
    def fit(self, positions: ArrayLike) -> tuple[_F64, float]:
        """Returns the q (r,) whose shape is nearest to positions (V, 3), and the share of the displacements that remains.

        Where modes depend on each other, returns the q with the smallest norm, in which each q_k counts times the norm of mode k.
        """
    @property
    def vertices(self) -> _F64:
        """Rest positions, (V, 3); a copy."""
    @property
    def weld(self) -> bool:
        """Whether ``certify`` welds equal vertices by default: the file's format splits them (STL, glTF)."""
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
        """The name of the metric: energy, displacement, mass, identity or given."""
    @property
    def metric_factor(self) -> _F64:
        """The factor S of ``norm = |S q|``: its diagonal (r,), or S itself (r, r)."""
    @property
    def units(self) -> str:
        """The unit of length, or empty."""
    @property
    def provenance(self) -> str:
        """The origin of mesh and modes, or empty."""
    @property
    def mode_names(self) -> list[str]:
        """Names of the modes (r), such as those of morph targets; empty if unknown."""
    @property
    def default_q(self) -> _F64:
        """The default weights of a glTF file (r,); 0 for other models."""
    @property
    def stiffness(self) -> _F64 | None:
        """The reduced stiffness at rest (r, r); None if unknown."""
    @property
    def deviations(self) -> _F64 | None:
        """The standard deviation of each entry of q (r,), for principal components; read-only. None if unknown."""

@final
class Certificates:
    """Certificates of a model, and queries. Any number of threads may use them at once.

    ``docs/guarantees.md`` states what each answer proves, and its error. Each call copies its arrays first, so later
    writes to them change nothing. Radii and norms are lengths ``|S (q - center)|`` in the metric of the certificates.
    """

    @classmethod
    def load(cls, path: _Path, model: Model) -> Certificates:
        """Reads ``*.sscc.safetensors``; refuses certificates of another model (ValueError)."""
    def save(self, path: _Path) -> None:
        """Writes ``*.sscc.safetensors``, whole or not at all."""
    def check(self, q: ArrayLike, limit: SupportsIndex | None = None) -> Answer:
        """Returns the pairs of triangles that collide at q (r,). ``limit`` (at least 1): the search ends after this number of
        pairs. More than 67,108,864 pairs raise ValueError, unless ``limit`` is at most this number."""
    def within(
        self, q: ArrayLike, clearance: float, *, rings: SupportsIndex | None = None
    ) -> tuple[_U32, _F64]:
        """Returns all pairs (n, 2) nearer than a clearance at q (r,), and their distances (n,), equal to those that
        ``Detector.within`` finds at the positions. Clearance and distances are in the unit of the model.

        Certificates of this clearance or a larger one, with at most this number of rings, answer most q by one comparison.
        """
    def check_many(
        self,
        Q: ArrayLike,
        limit: SupportsIndex | None = None,
        *,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> Batch:
        """Runs ``check`` for every row of Q (n, r). ``threads``, ``progress``: as in ``Model.certify``."""
    def continuous(self, q0: ArrayLike, q1: ArrayLike) -> Impacts:
        """Returns the pairs that collide between q0 and q1, and their times of impact. Each vertex moves on a straight line."""
    def safe_scale(self, q: ArrayLike) -> float:
        """Returns a scale s: the shape is proven free at ``center + t (q - center)`` for all t from 0 to s. It is 0 if the shape
        collides at the centre, triangles are closer there than rounding errors, or a coordinate there is beyond half of the
        range; else infinite if q is the centre or no mode moves a vertex."""
    def sweep(
        self,
        range: ArrayLike | None = None,
        *,
        q: ArrayLike | None = None,
        modes: Sequence[int | str] | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> list[Sweep]:
        """Finds for each mode, upwards and downwards, the first weight at which the shape touches itself.

        range: (2,) or (r, 2), the ends of the weights. None means 0 to 1 for morph targets, three standard deviations for
            principal components, else the weights that move some vertex by half the diagonal of the AABB.
        q: the weights at the start (r,). The other modes keep them. None means the centre.
        modes: numbers or names. None means all modes.
        threads, progress: as in ``Model.certify``.
        """
    def intervals(
        self,
        range: ArrayLike | None = None,
        *,
        samples: int | None = None,
        q: ArrayLike | None = None,
        modes: Sequence[int | str] | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> list[Intervals]:
        """Finds for each mode all intervals of its weight over which the shape collides, with numbers of pairs and depths.

        samples: samples of each weight, from 2 to 2^20. None means 101. Their pairs are exact, and depths are rounded. Outside
            of the intervals, up to their ``free_until`` and from their ``free_from`` on, the shape is proven free.
        range, q, modes, threads, progress: as in ``sweep``.
        """
    def resolve(self, q: ArrayLike, start: ArrayLike | None = None, *, all: bool | None = None) -> Resolved:
        """Returns a free q near q, on a free path from ``start`` (None: the centre), which must be free. Exceptions may keep
        colliding, unless ``all`` is True."""
    def free_samples(
        self,
        draws: ArrayLike,
        *,
        resolve: bool | None = None,
        start: ArrayLike | None = None,
        all: bool | None = None,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> FreeSamples:
        """Returns free configurations from the rows of draws (n, r) of any distribution. Colliding draws are resolved as by
        ``resolve``. With ``resolve=False`` they are rejected, even if only exceptions collide; ``start`` and ``all`` are then
        refused."""
    def clamp(self, q: ArrayLike) -> _F64 | None:
        """Returns q, or the last point on the line from the centre to q that the root's certificate proves free. Returns None if
        its radius is 0, there are exceptions, or the certificates have a ``clearance``."""
    def norm(self, q: ArrayLike) -> float:
        """Returns ``|S (q - center)|``, rounded up."""
    def radius(self, node: SupportsIndex) -> float:
        """Returns the norm below which no two triangles of the node collide (with a ``clearance``: come nearer than it), apart
        from exceptions."""
    def kinetic(self) -> KineticQuery:
        """Returns a query for a sequence of q with small steps."""
    @property
    def model(self) -> Model:
        """The model of the certificates."""
    @property
    def root_radius(self) -> float:
        """The norm below which the whole shape is free, apart from exceptions. With a ``clearance``, the shape keeps the
        clearance below this norm, but triangles within the rings may collide."""
    @property
    def global_radius(self) -> float:
        """The largest radius: radii are computed up to it. It may be infinite."""
    @property
    def epsilon(self) -> float:
        """The allowed relative error of the root's radius."""
    @property
    def metric(self) -> str:
        """The name of the metric: energy, displacement, mass, identity or given."""
    @property
    def metric_factor(self) -> _F64:
        """The factor S: its diagonal (r,), or S itself (r, r)."""
    @property
    def center(self) -> _F64:
        """The q from which radii are measured, (r,)."""
    @property
    def neighbours(self) -> str:
        """Which triangles with a common vertex count: "exclude" or "include-one-vertex"."""
    @property
    def weld(self) -> bool:
        """Whether vertices of equal position and modes are one, for adjacency."""
    @property
    def ignored(self) -> _U32:
        """Pairs that never count, (n, 2)."""
    @property
    def exceptions(self) -> _U32:
        """Pairs that collide at the centre, (n, 2): no radius covers them, and every query tests them. With a ``clearance``,
        pairs that are nearer than it there, or hardly farther apart."""
    @property
    def clearance(self) -> float | None:
        """The clearance that triangles keep below the radii; None if radii are about collisions."""
    @property
    def rings(self) -> int | None:
        """Triangles within this number of rings of each other need not keep the clearance; None without a clearance."""
    @property
    def rest_collisions(self) -> int:
        """Number of pairs that collide at rest, including ignored pairs."""
    @property
    def nodes(self) -> int:
        """Number of nodes of the BVH."""
    @property
    def pairs(self) -> int:
        """Number of node pairs with a stored radius."""
    @property
    def pair_limit(self) -> float:
        """The norm below which the pair tree has every node pair that can collide (with a ``clearance``: come nearer than it);
        0 without a pair tree."""
    @property
    def local_certificates(self) -> int:
        """Number of nodes with a local certificate."""
    @property
    def digest(self) -> str:
        """BLAKE3 of the model and the scope of the certificates, in hexadecimal."""
    @property
    def hierarchy(self) -> Hierarchy:
        """The BVH over the triangles, with the radius of each node."""

@final
class Hierarchy:
    """The BVH over the triangles. Node n holds ``order[first[n]:first[n] + count[n]]``; node 0 is the root."""

    @property
    def parent(self) -> _I32:
        """The parent of each node (nodes,), -1 for the root."""
    @property
    def level(self) -> _I32:
        """The level of each node (nodes,), 0 for the root."""
    @property
    def first(self) -> _U32:
        """The index in ``order`` of the first triangle of each node (nodes,)."""
    @property
    def count(self) -> _U32:
        """The number of triangles of each node (nodes,)."""
    @property
    def order(self) -> _U32:
        """The triangles, (F,), in an order in which those of each node are consecutive."""
    @property
    def radius(self) -> _F64:
        """The radius of each node (nodes,), see ``Certificates.radius``."""
    def __len__(self) -> int: ...

@final
class KineticQuery:
    """Runs ``check`` for a q that changes little from call to call: the same answers, at less cost. Calls from several threads
    run one after the other."""

    def check(self, q: ArrayLike) -> Answer:
        """Returns the pairs of triangles that collide at q (r,), as ``Certificates.check``."""

@final
class Answer:
    """The result of a query at one q. It has no truth value: use ``colliding``."""

    @property
    def pairs(self) -> _U32:
        """Colliding pairs (i, j), i < j, sorted: (n, 2), read-only."""
    @property
    def colliding(self) -> bool:
        """Whether any pair collides."""
    @property
    def count(self) -> int:
        """Number of pairs; a lower bound if not ``complete``."""
    @property
    def norm(self) -> float:
        """``|S (q - center)|``, rounded up."""
    @property
    def complete(self) -> bool:
        """Whether all pairs are listed; False if ``limit`` stopped the search."""
    @property
    def root_certified(self) -> bool:
        """Whether the root proved the shape free, apart from exceptions, by its radius or its local certificate."""
    @property
    def proof(self) -> Literal["radius", "local", "search"]:
        """The proof of the answer, apart from exceptions: the root's radius, the root's local certificate, or a search."""
    @property
    def opened(self) -> int:
        """Number of opened nodes and node pairs."""
    @property
    def box_tests(self) -> int:
        """Number of pairs of boxes that were compared."""
    @property
    def triangle_tests(self) -> int:
        """Number of pairs of triangles that were tested exactly."""

@final
class Impacts:
    """The result of a continuous query. It has no truth value: use ``colliding``."""

    @property
    def pairs(self) -> _U32:
        """Pairs that collide during the motion, sorted: (n, 2), read-only."""
    @property
    def times(self) -> _F64:
        """The time of impact of each pair, from 0 to 1: (n,), read-only."""
    @property
    def time_of_impact(self) -> float | None:
        """The earliest time of impact; None if the shape is free from q0 to q1."""
    @property
    def colliding(self) -> bool: ...
    @property
    def count(self) -> int: ...
    @property
    def norm(self) -> float:
        """The larger norm of q0 and q1."""
    @property
    def complete(self) -> bool: ...
    @property
    def root_certified(self) -> bool: ...
    @property
    def proof(self) -> Literal["radius", "local", "search"]: ...
    @property
    def opened(self) -> int: ...
    @property
    def box_tests(self) -> int: ...
    @property
    def triangle_tests(self) -> int: ...

@final
class Batch:
    """The answers for n configurations: read-only arrays (n,) with one entry for each, and ``batch[i]``, an Answer."""

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
    def proof(self) -> _Str:
        """The proof of each answer, as ``Answer.proof``."""
    @property
    def opened(self) -> _U64: ...
    @property
    def triangle_tests(self) -> _U64: ...
    @property
    def pairs(self) -> _U32:
        """The pairs of all answers, joined: (m, 2)."""
    @property
    def offsets(self) -> _I64:
        """(n + 1,): the pairs of answer i are ``pairs[offsets[i]:offsets[i + 1]]``."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex, /) -> Answer: ...
    def __iter__(self) -> Iterator[Answer]: ...

def self_intersections(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    weld: bool | ArrayLike | None = None,
    neighbours: Literal["exclude", "include-one-vertex", "include-folded"] | None = None,
) -> _U32:
    """Returns the pairs of triangles of a mesh that have a point in common, exactly: (n, 2), i < j, sorted. Touching counts.

    vertices: (V, 3); faces: (F, 3) integers, counted from 0. A mesh without faces has no pairs.
    weld, neighbours: as in ``Detector``; by default all pairs count that share no vertex number.

    The predicates are exact: the result is that of real arithmetic on the float64 positions. For many positions of one
    mesh, ``Detector`` builds its BVH once. Ctrl-C stops the search. Raises TypeError or ValueError.
    """

@final
class Detector:
    """Collisions of any deforming mesh at given positions, without modes. Several threads may use it at once.

    The detector builds a BVH once, refits it in each call, and rebuilds it if its cost has grown. Answers do not depend on
    the BVH. Each call copies its arrays first.

    faces: (F, 3) integers, vertex numbers counted from 0; at least one face.
    rest: (V, 3), the positions for which the BVH is built. None means the first positions that are checked, which also set V.
    weld: True: vertices of equal rest position are one vertex, for adjacency (needs ``rest``). (V,) integers:
        vertices with the same number are one. False (default): every vertex number is a separate vertex.
    neighbours: "exclude" (default): triangles that share a vertex do not count; "include-one-vertex": triangles that
        share one vertex count if they have another common point; "include-folded": triangles that share one, two or
        three vertices count if they have a common point other than these vertices and the edges between them, and doubled
        faces count. ``continuous`` refuses "include-folded".
    ignored: (n, 2), pairs of triangles that never count.
    groups: the group of each triangle (F,), from 0 to 65535. None means no groups.
    ignore_groups: pairs of groups (n, 2): triangles of these two groups do not count. A pair (a, a) ignores pairs within
        group a.

    Raises TypeError or ValueError; the message names the argument and the row.
    """

    def __new__(
        cls,
        faces: ArrayLike,
        rest: ArrayLike | None = None,
        *,
        weld: bool | ArrayLike | None = None,
        neighbours: Literal["exclude", "include-one-vertex", "include-folded"] | None = None,
        ignored: ArrayLike | None = None,
        groups: ArrayLike | None = None,
        ignore_groups: ArrayLike | None = None,
    ) -> Detector: ...
    def check(
        self, positions: ArrayLike, limit: SupportsIndex | None = None, *, first: bool | None = None
    ) -> DetectorAnswer:
        """Returns the pairs of triangles that collide at these positions (V, 3), exactly.

        ``limit`` (at least 1): the search ends after this number of pairs; ``first=True``: after one.
        """
    def check_many(
        self,
        frames: ArrayLike,
        limit: SupportsIndex | None = None,
        *,
        threads: int | None = None,
        progress: _Progress = None,
    ) -> DetectorBatch:
        """Runs ``check`` for every frame (T, V, 3). ``threads``, ``progress``: as in ``Model.certify``."""
    def continuous(self, x0: ArrayLike, x1: ArrayLike) -> DetectorImpacts:
        """Returns the pairs that collide while each vertex moves on a straight line from x0 to x1 (V, 3), and their times."""
    def against(
        self, positions: ArrayLike, other: Detector, other_positions: ArrayLike
    ) -> DetectorAnswer:
        """Returns the pairs (triangle of this mesh, triangle of the other) that have a point in common, exactly.

        All such pairs count: ``neighbours``, ``weld``, ``ignored`` and groups apply within one mesh.
        """
    def against_continuous(
        self, x0: ArrayLike, x1: ArrayLike, other: Detector, y0: ArrayLike, y1: ArrayLike
    ) -> DetectorImpacts:
        """Returns the pairs of ``against`` that collide while this mesh moves from x0 to x1 and the other from y0 to y1."""
    def within(
        self, positions: ArrayLike, clearance: float, *, rings: SupportsIndex | None = None
    ) -> tuple[_U32, _F64]:
        """Returns the pairs nearer than a distance, sorted: (n, 2), and their distances (n,), which are 0 if they collide.

        Distances are in the unit of the positions, with an error of at most 2^-40 of the size of both triangles. Triangles with a
        common vertex never count.
        ``rings``: triangles within this number of rings of each other on the surface do not count either. With 1 (default) these
        are triangles with a common vertex, with 2 also triangles with a common neighbour of this kind, and so on.
        """
    def within_against(
        self, positions: ArrayLike, other: Detector, other_positions: ArrayLike, clearance: float
    ) -> tuple[_U32, _F64]:
        """Returns the pairs (triangle of this mesh, triangle of the other) nearer than a distance, and their distances."""
    def nearest(
        self, positions: ArrayLike, *, rings: SupportsIndex | None = None
    ) -> tuple[float, tuple[int, int]] | None:
        """Returns the smallest distance of two triangles that count as in ``within``, and these. None if no pair counts."""
    def nearest_against(
        self, positions: ArrayLike, other: Detector, other_positions: ArrayLike
    ) -> tuple[float, tuple[int, int]] | None:
        """Returns the smallest distance of this mesh and the other one, and its triangles."""
    def enclosed(
        self, positions: ArrayLike, other: Detector, other_positions: ArrayLike
    ) -> tuple[tuple[int, int], tuple[int, int]]:
        """Returns the number of connected components of this mesh that are inside the other mesh, and the number of all its
        components; then the same numbers for the components of the other mesh inside this one. The result is valid if ``against``
        finds no pair. Only closed parts have an inside: triangles that common edges join, and that run along every edge as often in
        one direction as in the other. Open components can be inside of them.
        """
    def penetration(
        self, positions: ArrayLike, other: Detector, other_positions: ArrayLike
    ) -> BodyPenetration:
        """Returns the volume inside both meshes, in the third power of the unit of the positions, and the diameter of the largest
        ball inside both. Both meshes must be closed."""
    @property
    def faces(self) -> _U32:
        """Vertex numbers, (F, 3); a copy."""
    @property
    def rest(self) -> _F64 | None:
        """The argument ``rest``, (V, 3); a copy."""
    @property
    def neighbours(self) -> str: ...
    @property
    def weld(self) -> bool | _U32:
        """The argument ``weld``; classes (V,) are numbered from 0."""
    @property
    def ignored(self) -> _U32:
        """Pairs that never count, (n, 2)."""
    @property
    def groups(self) -> _U32 | None:
        """The group of each triangle, (F,); None if all pairs of groups count."""
    @property
    def ignored_groups(self) -> _U32:
        """Pairs of groups that do not count, (n, 2)."""

@final
class DetectorAnswer:
    """The result at given positions. It has no truth value: use ``colliding``.

    Answers are equal if their ``pairs`` and ``complete`` are equal. Their cost depends on the state of the BVH.
    """

    @property
    def pairs(self) -> _U32:
        """Colliding pairs, sorted: (n, 2), read-only. Within one mesh i < j."""
    @property
    def colliding(self) -> bool:
        """Whether any pair collides."""
    @property
    def count(self) -> int:
        """Number of pairs; a lower bound if not ``complete``."""
    @property
    def complete(self) -> bool:
        """Whether all pairs are listed; False if ``limit`` or ``first`` stopped the search."""
    @property
    def opened(self) -> int:
        """Number of opened nodes and node pairs."""
    @property
    def box_tests(self) -> int:
        """Number of pairs of boxes that were compared."""
    @property
    def triangle_tests(self) -> int:
        """Number of pairs of triangles that were tested exactly."""
    @property
    def tree_cost(self) -> float:
        """The cost of the refitted BVH by the surface area heuristic."""
    @property
    def rebuilds(self) -> int:
        """Number of times that this copy of the BVH has been rebuilt."""
    def curves(self) -> list[Curve]:
        """Returns the curves in which the surfaces intersect: the intersection segments of all pairs, joined.

        Segments are joined by the vertices, edges and faces on which their ends lie, without a tolerance. Pairs that meet
        in one point or in a polygon (coplanar triangles) add no segment. A curve ends at a border of the mesh, at such a
        polygon, at a point where more than two segments meet, and at a pair that is not listed.
        """
    def depths(self) -> _F64:
        """Returns the penetration depth of each pair, (n,): the length of the smallest translation after which its triangles
        only touch. It is 0 if they already only touch, and for coplanar triangles."""
    def directions(self) -> _F64:
        """Returns the direction of this translation for the second triangle of each pair, (n, 3): unit vectors."""

@final
class DetectorImpacts:
    """The result between given positions. It has no truth value: use ``colliding``.

    Impacts are equal if their ``pairs``, ``times`` and ``complete`` are equal.
    """

    @property
    def pairs(self) -> _U32:
        """Pairs that collide during the motion, sorted: (n, 2), read-only."""
    @property
    def times(self) -> _F64:
        """The time of impact of each pair, from 0 to 1: (n,), read-only."""
    @property
    def time_of_impact(self) -> float | None:
        """The earliest time of impact; None if the shape is free from start to end."""
    @property
    def colliding(self) -> bool: ...
    @property
    def count(self) -> int: ...
    @property
    def complete(self) -> bool: ...
    @property
    def opened(self) -> int: ...
    @property
    def box_tests(self) -> int: ...
    @property
    def triangle_tests(self) -> int: ...
    @property
    def tree_cost(self) -> float: ...
    @property
    def rebuilds(self) -> int: ...

@final
class DetectorBatch:
    """The answers for T frames: read-only arrays (T,) with one entry for each, and ``batch[t]``, a DetectorAnswer."""

    @property
    def colliding(self) -> _Bool: ...
    @property
    def count(self) -> _I64: ...
    @property
    def complete(self) -> _Bool: ...
    @property
    def opened(self) -> _U64: ...
    @property
    def box_tests(self) -> _U64: ...
    @property
    def triangle_tests(self) -> _U64: ...
    @property
    def tree_cost(self) -> _F64: ...
    @property
    def pairs(self) -> _U32:
        """The pairs of all frames, joined: (m, 2)."""
    @property
    def offsets(self) -> _I64:
        """(T + 1,): the pairs of frame t are ``pairs[offsets[t]:offsets[t + 1]]``."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex, /) -> DetectorAnswer: ...
    def __iter__(self) -> Iterator[DetectorAnswer]: ...

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
def _numbers(given: ArrayLike, name: str) -> _F64: ...
def _integers(given: ArrayLike, name: str) -> _I64: ...
def _triangulated(
    place: str, counts: ArrayLike, corners: ArrayLike, positions: ArrayLike
) -> tuple[_U32, list[str]]: ...
def _scene_contents(
    path: _Path,
) -> tuple[list[tuple[int, str | None, str | None, int, int]], list[tuple[str | None, float]]]: ...
def _scene_positions(
    path: _Path, node: str | None, animation: str | None, times: ArrayLike | None, fps: float | None
) -> _F64: ...
def _check_scene(
    path: _Path,
    animation: str | None,
    times: ArrayLike | None,
    fps: float | None,
    node: str | None,
    between_nodes: bool,
    continuous: bool,
    clearance: float | None,
    groups: tuple[list[str], list[str], str | bytes | None],
    neighbours: str | None,
    ignore_rest: int | bool | None,
    limit: int | None,
    threads: int | None,
    progress: _Progress,
    phases: int,
) -> list[SceneAnswer]: ...

# Functions for sscc.batch.

def _certificates(bytes: bytes, model: Model) -> Certificates: ...

@final
class _ShardWorker:
    def __new__(cls, model: Model, keywords: dict[str, Any]) -> _ShardWorker: ...
    def run(self, job: bytes) -> bytes: ...

def _build() -> str: ...
def _certify_in_shards(
    model: Model, keywords: dict[str, Any], shards: int, run: Callable[[list[bytes], float], list[bytes]]
) -> Certificates: ...
def _check_options(model: Model | None, keywords: dict[str, Any]) -> None: ...
def _configurations(certificates: Certificates, Q: ArrayLike) -> _F64: ...
def _joined(batches: list[Batch]) -> Batch: ...
