"""Scenes of glTF files: collisions of each mesh with itself and with the others, at the positions that a player shows."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sscc._sscc import _check_scene, _scene_contents, _scene_positions
from sscc._text import counted, number, quoted


class SceneNode(NamedTuple):
    """A node that shows a mesh with triangles."""

    node: int
    """The number of the node in the file."""
    name: str | None
    """The name of the node. Names may repeat."""
    mesh: str | None
    """The name of the node's mesh."""
    vertices: int
    triangles: int

    def __repr__(self) -> str:
        name = "" if self.name is None else f" {quoted(self.name)}"
        return f"<sscc.SceneNode: {self.node}{name}, {counted(self.triangles, 'triangle')}>"


class SceneAnimation(NamedTuple):
    """An animation."""

    name: str | None
    duration: float
    """The time of the last key frame (s)."""

    def __repr__(self) -> str:
        name = "without a name" if self.name is None else quoted(self.name)
        return f"<sscc.SceneAnimation: {name}, {number(self.duration)} s>"


@dataclass(frozen=True, eq=False, repr=False)
class SceneAnswer:
    """The result of one node at one time, or of two nodes; ``against_node`` is then the second node."""

    node: int
    """The number of the node."""
    node_name: str | None
    against_node: int | None
    """The number of the second node; None for the mesh of ``node`` with itself."""
    against_node_name: str | None
    index: int
    """The number of the time, counted from 0; for continuous queries, of the time at the start."""
    time: float | None
    """The time (s); None for the scene as it is stored."""
    pairs: NDArray[np.uint32]
    """Pairs that collide, or are nearer than the clearance: (n, 2), sorted, read-only. For two nodes, each pair is a triangle
    of ``node`` and a triangle of ``against_node``."""
    times: NDArray[np.float64] | None
    """The time of impact (0 to 1) of each pair, for continuous queries."""
    distances: NDArray[np.float64] | None
    """The distance of each pair, if a clearance is given."""
    distance: float | None
    """The smallest distance, if a clearance is given; None if no pair counts."""
    complete: bool
    """Whether all pairs are listed."""

    @property
    def colliding(self) -> bool:
        """Whether any pair collides. With a clearance: whether the distance of any pair is 0."""
        return len(self.pairs) > 0 if self.distances is None else bool((self.distances == 0).any())

    def __repr__(self) -> str:
        def named(node: int | None, name: str | None) -> str:
            return f"node {node}" if name is None else f"node {node} {quoted(name)}"

        place = named(self.node, self.node_name)
        if self.against_node is not None:
            place += f" against {named(self.against_node, self.against_node_name)}"
        at = "" if self.time is None else f" at {number(self.time)} s"
        found = counted(len(self.pairs), "pair") if len(self.pairs) else "free"
        return f"<sscc.SceneAnswer: {place}{at}: {found}>"


class Scene:
    """A glTF file (``.glb``, ``.gltf``, ``.vrm``): meshes at nodes, and animations that move them.

    >>> scene = sscc.Scene.load("character.glb")
    >>> [answer for answer in scene.check(animation="wave", fps=10) if answer.colliding]
    """

    path: Path
    nodes: list[SceneNode]
    animations: list[SceneAnimation]

    def __init__(self, path: str | PathLike[str]) -> None:
        nodes, animations = _scene_contents(path)
        self.path = Path(path)
        self.nodes = [SceneNode(*node) for node in nodes]
        self.animations = [SceneAnimation(*animation) for animation in animations]

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Scene:
        """Reads the contents of a file. Raises FileNotFoundError, OSError, ValueError."""
        return cls(path)

    def __repr__(self) -> str:
        nodes = counted(len(self.nodes), "node")
        animations = counted(len(self.animations), "animation")
        return f"<sscc.Scene: {quoted(self.path)}, {nodes} with a mesh, {animations}>"

    def check(
        self,
        animation: str | int | None = None,
        *,
        times: ArrayLike | None = None,
        fps: float | None = None,
        node: str | int | None = None,
        between_nodes: bool | None = None,
        continuous: bool = False,
        clearance: float | None = None,
        ignore_groups: Iterable[str] = (),
        only_groups: Iterable[str] = (),
        group_by: str | PathLike[str] | None = None,
        neighbours: Literal["exclude", "include-one-vertex", "include-folded"] | None = None,
        ignore_rest: int | bool | None = None,
        limit: int | None = None,
        threads: int | None = None,
        progress: bool | Callable[[float], object] | None = None,
    ) -> list[SceneAnswer]:
        """Checks every mesh with itself and with the others, as ``sscc check --between-nodes`` does.

        animation: its name or number. None means the scene as it is stored.
        times, fps: the times at which the animation is checked (s), or their rate (times per second). None means 30 per second.
        node: the name or number of the only node. None means all nodes.
        between_nodes: whether two nodes are compared with each other. None means yes.
        continuous: whether the motion from each time to the next is checked, with every vertex on a straight line.
        clearance: finds pairs nearer than this instead of pairs that collide.
        ignore_groups, only_groups: pairs "A,B" of names of nodes, meshes and materials. The former do not count; with the latter,
            no others count. group_by: "node", "mesh", "material", "group" (primitives) or a file of numbers. None means any name.
        ignore_rest: True: pairs that collide at rest do not count, nor pairs of two nodes that collide at the first time. A
            number: in addition, pairs within this number of rings of them do not count.
        limit: the maximum number of pairs of each answer.

        Returns one answer for each node and time, then, time by time, one for each two nodes that collide (or are near). Raises
        FileNotFoundError, OSError, ValueError, TypeError.
        """
        if clearance is not None and neighbours is not None:
            raise ValueError("clearance: triangles with a common vertex never count: leave out neighbours")
        if continuous and animation is None:
            raise ValueError("continuous: a scene at rest has no motion: give an animation")
        only, ignored = _pairs(only_groups, "only_groups"), _pairs(ignore_groups, "ignore_groups")
        if only and ignored:
            raise ValueError("give ignore_groups or only_groups, not both")
        is_compared = between_nodes is not False and node is None and len(self.nodes) > 1
        return _check_scene(
            self.path,
            _name(animation, "animation"),
            times,
            fps,
            _name(node, "node"),
            True if between_nodes is None else between_nodes,
            continuous,
            clearance,
            (ignored, only, None if group_by is None else fspath(group_by)),
            neighbours,
            ignore_rest,
            limit,
            threads,
            progress,
            2 if is_compared else 1,
        )

    def positions(
        self,
        node: str | int,
        animation: str | int | None = None,
        *,
        times: ArrayLike | None = None,
        fps: float | None = None,
    ) -> NDArray[np.float64]:
        """Returns the positions of a node's mesh at each time, as a player shows them: (T, V, 3). ``times`` and ``fps`` are as in
        ``check``. Raises FileNotFoundError, OSError, ValueError, TypeError."""
        return _scene_positions(self.path, _name(node, "node"), _name(animation, "animation"), times, fps)


def _name(name: str | int | None, argument: str) -> str | None:
    if name is None or isinstance(name, str):
        return name
    if isinstance(name, bool) or not isinstance(name, (int, np.integer)):
        raise TypeError(f"{argument} is a {type(name).__name__}: a name or a number was expected")
    return str(int(name))


def _pairs(pairs: Iterable[str], argument: str) -> list[str]:
    found = [pairs] if isinstance(pairs, str) else list(pairs)
    if not all(isinstance(pair, str) for pair in found):
        raise TypeError(f'{argument}: texts "A,B" were expected')
    return found
