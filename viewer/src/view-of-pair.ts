/** The direction from which a pair of triangles is best seen: both face the eye, with few triangles in front of them. */
import type { Vector } from "./shape";

/** A surface of the picture. */
export interface Surface {
    positions: Float32Array;
    faces: Uint32Array;
    /** The triangles of the pair that belong to it. */
    own: number[];
}

/** Number of directions that are compared, beside the present one. */
const DIRECTIONS = 128;
/** The cost of one surface in front of the pair; further ones cost as much, up to `MAX_LAYERS`. */
const LAYER_COST = 0.5;
const MAX_LAYERS = 4;
/** The advantage of the present direction over the opposite one is twice this number. */
const TURN_COST = 0.12;
/** Largest share of the vertical axis in a direction: the camera cannot turn if it looks along this axis. */
const MAX_SLOPE = 0.94;

const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vector, b: Vector): Vector => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
];
const unit = (a: Vector): Vector => {
    const length = Math.hypot(...a) || 1;
    return [a[0] / length, a[1] / length, a[2] / length];
};

/** Unit vectors that are spread evenly over the sphere. */
function sphere(n: number): Vector[] {
    const turn = Math.PI * (3 - Math.sqrt(5));
    return Array.from({ length: n }, (_, i) => {
        const z = 1 - (2 * i + 1) / n;
        const r = Math.sqrt(1 - z * z);
        return [r * Math.cos(i * turn), r * Math.sin(i * turn), z];
    });
}

/**
 * Returns the unit vector from a pair to the eye. `normals`: of both triangles, of any length; `now`: the present direction to
 * the eye; `up`: the vertical axis. It takes about 100 dot products for each triangle.
 */
export function bestView(surfaces: Surface[], middle: Vector, normals: Vector[], now: Vector, up: Vector): Vector {
    const directions = [unit(now), ...sphere(DIRECTIONS).filter((d) => Math.abs(dot(d, up)) < MAX_SLOPE)];
    const layers = new Uint16Array(directions.length);
    for (const surface of surfaces) countLayers(surface, middle, directions, layers);
    const sides = normals.filter((normal) => Math.hypot(...normal) > 0).map(unit);
    const score = (d: Vector, i: number): number => {
        const facing = sides.reduce((product, normal) => product * Math.abs(dot(normal, d)), 1);
        return Math.sqrt(facing) - LAYER_COST * Math.min(layers[i], MAX_LAYERS) + TURN_COST * dot(d, directions[0]);
    };
    const scores = directions.map(score);
    return directions[scores.indexOf(Math.max(...scores))];
}

/** Counts for each direction the triangles that the ray from the middle meets, without the pair and its neighbours. */
function countLayers(surface: Surface, middle: Vector, directions: Vector[], layers: Uint16Array): void {
    const { positions: x, faces, own } = surface;
    const vertices = new Set(own.flatMap((t) => [...faces.subarray(3 * t, 3 * t + 3)]));
    const corner = (v: number): Vector => [x[3 * v] - middle[0], x[3 * v + 1] - middle[1], x[3 * v + 2] - middle[2]];
    for (let t = 0; t < faces.length; t += 3) {
        const [i, j, k] = [faces[t], faces[t + 1], faces[t + 2]];
        if (vertices.has(i) || vertices.has(j) || vertices.has(k)) continue;
        const [a, b, c] = [corner(i), corner(j), corner(k)];
        const center = unit([a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]]);
        // The triangle is within the cone about its centre that contains the directions to its corners.
        const cosine = Math.min(dot(center, unit(a)), dot(center, unit(b)), dot(center, unit(c)));
        let sides: [Vector, Vector, Vector] | null = null;
        for (let i = 0; i < directions.length; i++) {
            const d = directions[i];
            if (d[0] * center[0] + d[1] * center[1] + d[2] * center[2] < cosine) continue;
            sides ??= [cross(a, b), cross(b, c), cross(c, a)];
            const [ab, bc, ca] = [dot(sides[0], d), dot(sides[1], d), dot(sides[2], d)];
            if ((ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0)) layers[i]++;
        }
    }
}
