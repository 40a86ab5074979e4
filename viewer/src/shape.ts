/** A model's arrays, and its positions at q on the processor: x = p + U q. */
import type { Model } from "./protocol";
import type { Source } from "./source";

export type Vector = [number, number, number];

/** A factor larger than the rounding errors of |z|, here and in the certificates. */
const ROUNDING = 1 + 1e-12;

export class Shape {
    private constructor(
        readonly model: Model,
        readonly positions: Float32Array,
        readonly faces: Uint32Array,
        readonly modes: Float32Array,
    ) {}

    static async load(source: Source, model: Model): Promise<Shape> {
        const { positions, faces, modes } = model.arrays;
        const [p, f, u] = await Promise.all([
            source.array(positions),
            source.array(faces),
            modes === undefined ? new ArrayBuffer(0) : source.array(modes),
        ]);
        const shape = new Shape(model, new Float32Array(p), new Uint32Array(f), new Float32Array(u));
        const { vertices, triangles, rank } = model;
        const sizes = [shape.positions.length, shape.faces.length, shape.modes.length];
        const due = [3 * vertices, 3 * triangles, 3 * vertices * rank];
        if (sizes.some((size, i) => size !== due[i]))
            throw new Error(
                `the arrays of ${model.name} have wrong sizes: reload the page, or write the report anew`,
            );
        return shape;
    }

    /** Half the diagonal of the AABB. */
    get radius(): number {
        const { min, max } = this.model.box;
        return Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]) / 2 || 1;
    }

    get middle(): Vector {
        const { min, max } = this.model.box;
        return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
    }

    vertex(v: number, q: ArrayLike<number>): Vector {
        const { positions, modes } = this;
        let x = positions[3 * v];
        let y = positions[3 * v + 1];
        let z = positions[3 * v + 2];
        for (let k = 0; k < q.length; k++) {
            if (q[k] === 0) continue;
            const at = 3 * (k * this.model.vertices + v);
            x += modes[at] * q[k];
            y += modes[at + 1] * q[k];
            z += modes[at + 2] * q[k];
        }
        return [x, y, z];
    }

    deformed(q: ArrayLike<number>): Float32Array {
        const x = this.positions.slice();
        for (let k = 0; k < q.length; k++) {
            const weight = q[k];
            if (weight === 0) continue;
            const mode = this.modes.subarray(k * x.length, (k + 1) * x.length);
            for (let i = 0; i < x.length; i++) x[i] += mode[i] * weight;
        }
        return x;
    }

    /** The middle of triangles, and the largest distance of their corners from it. */
    around(triangles: number[], q: ArrayLike<number>): { middle: Vector; reach: number } {
        return around(triangles.map((t) => this.corners(t, q)));
    }

    /** The corners of a triangle. */
    corners(t: number, q: ArrayLike<number>): Vector[] {
        return [0, 1, 2].map((c) => this.vertex(this.faces[3 * t + c], q));
    }

    /** |z|; null if the metric is not diagonal. */
    norm(q: ArrayLike<number>): number | null {
        const { scales, center } = this.model;
        if (!scales) return null;
        return Math.hypot(...scales.map((s, k) => s * (q[k] - center[k])));
    }

    /**
     * Whether the root's certificate alone proves q free. With exceptions, or a metric that is not diagonal, the page
     * does not decide: false.
     */
    isRootCertified(q: ArrayLike<number>): boolean {
        const { root_radius: radius, exceptions } = this.model;
        const norm = this.norm(q);
        return exceptions === 0 && norm !== null && norm * ROUNDING < (radius ?? Number.POSITIVE_INFINITY);
    }

    /** The name of a mode, else its number from 0. */
    modeName(k: number): string {
        return this.model.mode_names?.[k] || `mode ${k}`;
    }

    /** The range of a mode's slider, such as 0 to 1 for morph targets; in reports of earlier versions center +- limits. */
    range(k: number): readonly [number, number] {
        const { center, limits, ranges } = this.model;
        return ranges?.[k] ?? [center[k] - limits[k], center[k] + limits[k]];
    }

    /** Whether the range of a mode begins or ends at its centre, as that of a morph target. */
    isOneSided(k: number): boolean {
        return this.range(k).includes(this.model.center[k]);
    }

    frequency(k: number): string {
        const hertz = this.model.frequencies?.[k];
        if (hertz === null || hertz === undefined) return "";
        return hertz >= 1000 ? `${(hertz / 1000).toPrecision(3)} kHz` : `${hertz.toPrecision(3)} Hz`;
    }
}

/** The middle of triangles, given by their corners, and the largest distance of a corner from it. */
export function around(triangles: Vector[][]): { middle: Vector; reach: number } {
    const corners = triangles.flat();
    const middle: Vector = [0, 0, 0];
    for (const corner of corners) for (let c = 0; c < 3; c++) middle[c] += corner[c] / corners.length;
    const reach = Math.max(...corners.map((x) => Math.hypot(...x.map((v, c) => v - middle[c]))));
    return { middle, reach };
}
