/** What the page is given: the scene, and the answers of the local server. Arrays travel by name, little-endian. */

export interface Level {
    level: number;
    nodes: number;
    least: number | null;
    median: number | null;
    largest: number | null;
    /** Share of entries that were capped, 0 to 1. */
    capped: number;
}

export interface Model {
    name: string;
    triangles: number;
    vertices: number;
    rank: number;
    arrays: { positions: string; faces: string; modes: string };
    box: { min: number[]; max: number[] };
    frequencies: (number | null)[] | null;
    mode_names: string[] | null;
    /** z_k = scales[k] (q_k - center_k) where the metric is diagonal. */
    scales: number[] | null;
    center: number[];
    default_q: number[];
    limits: number[];
    root_radius: number | null;
    global_radius: number | null;
    resolved_up_to: number | null;
    metric: string;
    exceptions: number;
    nodes: number;
    levels: Level[];
    extremal: { name: string; q: number[] }[];
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
    q: string;
    rigid: string | null;
    center: number[];
    /** Colliding pairs of triangles in each frame. */
    pairs: number[] | null;
}

export interface PlaybackData {
    times: number[];
    bodies: PlaybackBody[];
    /**
     * For each frame the most colliding pairs of all bodies in one step between the frame before and this one; null
     * where there are no such steps. Earlier versions wrote none, and counted these steps in the `pairs` of bodies.
     */
    pairs_since?: number[] | null;
    colliding: { offsets: string; triangles: string } | null;
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
}

export interface Answer {
    serial: number;
    norm: number;
    colliding: boolean;
    count: number;
    complete: boolean;
    pairs: [number, number][];
    /** Every triangle of any pair found; pairs may be too many to list. */
    triangles?: number[];
    microseconds: number;
    root_certified: boolean;
    opened: number;
    box_tests: number;
    triangle_tests: number;
    root_share: number | null;
    nodes?: { opened: number[]; culled: number[] };
}

export interface SafeScale {
    certified: number | null;
    first: { scale: number; pairs: [number, number][] } | null;
    /** The way is known so far. */
    searched: number | null;
    /** False where time ran out. */
    complete: boolean;
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
    count: number;
}
