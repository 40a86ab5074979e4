/** The data of the page: the scene, and the answers of the local server. Arrays are named and little-endian. */

export interface Level {
    level: number;
    nodes: number;
    least: number | null;
    median: number | null;
    largest: number | null;
    /** Share of the nodes whose radius is the global radius, from 0 to 1. */
    capped: number;
}

/** A model with modes and certificates. A mesh of a recording has neither: see mesh.ts. */
export interface Model {
    name: string;
    triangles: number;
    vertices: number;
    rank: number;
    /** A mesh has no modes. */
    arrays: { positions: string; faces: string; modes?: string };
    /** The AABB at rest; of a mesh, that of all frames. */
    box: { min: number[]; max: number[] };
    frequencies: (number | null)[] | null;
    mode_names: string[] | null;
    /** z_k = scales[k] (q_k - center_k) where the metric is diagonal. */
    scales: number[] | null;
    center: number[];
    default_q: number[];
    /** The weight at which a mode has moved some vertex by half the diagonal of the AABB. */
    limits: number[];
    /** The ranges of the sliders; reports of earlier versions have none, and their ranges are center +- limits. */
    ranges?: [number, number][];
    root_radius: number | null;
    global_radius: number | null;
    resolved_up_to: number | null;
    metric: string;
    exceptions: number;
    /** The sentences for a free shape, by what proves it; reports of earlier versions have none. */
    free?: { root: string; tests: string };
    nodes: number;
    levels: Level[];
    extremal: { name: string; q: number[] }[];
    /** The intervals of each mode about default_q, in a report of a sweep. */
    intervals?: Intervals[];
}

export interface Axis {
    label: string;
    log: boolean;
}

export interface Series {
    name: string;
    x: number[];
    y: (number | null)[];
}

export interface PlotData {
    title: string;
    x: Axis;
    y: Axis;
    series: Series[];
}

export interface PlaybackBody {
    name: string;
    model: number;
    /** q of each frame; undefined for a mesh. */
    q?: string;
    /** The positions of a mesh in each frame, relative to the centre; undefined for a model. */
    positions?: string;
    rigid: string | null;
    /** The point about which the body turns. Of meshes the origin of the page's coordinates, the same for all. */
    center: number[];
    /** Number of colliding pairs of triangles in each frame; of a continuous check, in the step after it. Null if unknown. */
    pairs: number[] | null;
}

/** Colliding pairs of each frame and body; of a continuous check those of the step after each frame. */
export interface ContactsData {
    /** The start of each list in `pairs`, ordered by frame, then by body; then the end. */
    offsets: string;
    pairs: string;
    /** Times of impact from 0 to 1, of a continuous check. */
    times: string | null;
    /** The body of each second triangle, where some pairs are of two bodies; earlier versions have none. */
    seconds?: string | null;
    /** Whether the second triangles belong to the second body. Otherwise, and without `seconds`, they belong to that of the list. */
    is_between: boolean;
}

export interface PlaybackData {
    times: number[];
    bodies: PlaybackBody[];
    /**
     * For each frame the largest number of colliding pairs of all bodies in one step between the previous frame and
     * this one; null without such steps. Earlier versions counted these steps in the `pairs` of bodies instead.
     */
    pairs_since?: number[] | null;
    /** The pairs that were not tested: ", apart from ...", or nothing; reports of earlier versions do not say. */
    apart?: string;
    colliding: { offsets: string; triangles: string } | null;
    /** Pairs and curves of meshes; reports of earlier versions have none. */
    contacts?: ContactsData | null;
    /** Segments of two points; offsets by frame. */
    curves?: { offsets: string; segments: string } | null;
    /** How a frame is named; by its time in reports of earlier versions. */
    clock?: "time" | "frame" | "frame_and_time";
    ground: number | null;
    sound: string | null;
    costs: PlotData | null;
}

export interface Scene {
    title: string;
    version: string;
    models: Model[];
    plots: PlotData[];
    playback: PlaybackData | null;
    summary: [string, string][];
}

export interface Report {
    scene: Scene;
    /** Base64. */
    arrays: Record<string, string>;
    /** The data by which the report itself checks q; most reports have none. */
    checks?: ChecksData | null;
}

/** The core as WebAssembly: its script, and the names of arrays that are compressed by zlib. */
export interface ChecksData {
    script: string;
    module: string;
    model: string;
    certificates: string;
}

export interface Answer {
    serial: number;
    norm: number;
    colliding: boolean;
    /** A lower bound if the answer is not complete. */
    count: number;
    complete: boolean;
    pairs: [number, number][];
    /** The triangles of all pairs found; `pairs` lists only the first ones. */
    triangles?: number[];
    microseconds: number;
    root_certified: boolean;
    /** The kind of proof of the answer, apart from exceptions. */
    proof: "radius" | "local" | "search";
    opened: number;
    box_tests: number;
    triangle_tests: number;
    root_share: number | null;
    nodes?: { opened: number[]; culled: number[] };
}

export interface SafeScale {
    certified: number | null;
    first: { scale: number; pairs: [number, number][] } | null;
    /** The scale up to which the search covers every shape; null: infinite. */
    searched: number | null;
    /** Whether the search ended before its time limit. */
    complete: boolean;
}

/** How far the weight of one mode can go in one direction. */
export interface Sweep {
    from: number;
    to: number;
    /** The shape is proven free from `from` up to this weight; null: it collides at `from`. */
    first_free: number | null;
    /** A weight at which the shape collides, the first one unless there is a note; null: none was found. */
    first_hit: number | null;
    pairs: [number, number][];
    count: number;
    /** A sentence about an unusual result; null for a usual one. */
    note: string | null;
}

/** An interval of weights over which the shape collides at every sample. */
export interface Interval {
    from: number;
    to: number;
    free_until: number | null;
    free_from: number | null;
    /** Whether the shape collides at both ends. */
    exact: boolean;
    pairs: number;
    depth: number;
    /** The weight of that depth. */
    deepest: number;
}

/** The intervals of one mode. Outside of them the shape is proven free: up to their `free_until`, and from their `free_from`. */
export interface Intervals {
    name: string;
    from: number;
    to: number;
    intervals: Interval[];
    /** Weight, pairs and largest depth of each sample. */
    samples: [number, number, number][];
}

export interface Nodes {
    parent: number[];
    level: number[];
    radius: (number | null)[];
    first: number[];
    count: number[];
    order: string;
}

export interface Boxes {
    boxes: [number, number, number, number, number, number][];
}

export interface Traditional {
    microseconds: number;
    /** A lower bound if the answer is not complete. */
    count: number;
    complete: boolean;
}
