/**
 * Writes a motion as GLB, with rigid motions on the nodes. If a body has given positions, each frame but the first is a
 * morph target. Otherwise the morph targets are the modes that move, scaled to their range, and a first target with the
 * weight 1 has the lower ends of all ranges. So all weights are in [0, 1], and programs that clamp weights to this
 * interval, as Blender does, show every vertex at its position.
 */
import type { Shape } from "./shape";

export interface MovingBody {
    name: string;
    shape: Shape;
    /** q of all frames (frames x r), row by row. */
    q: Float32Array;
    /** Positions of all frames, relative to the centre; null if q deforms the shape. */
    positions: Float32Array | null;
    /** x y z and a quaternion x y z w for each frame. */
    rigid: Float32Array | null;
    center: number[];
}

const FLOAT = 5126;
const UNSIGNED_INT = 5125;
const VERTEX_BUFFER = 34962;
const INDEX_BUFFER = 34963;

/** The parts of the binary buffer, with their views and accessors. */
class Buffer {
    readonly views: object[] = [];
    readonly accessors: object[] = [];
    readonly parts: Uint8Array[] = [];
    length = 0;

    /** Adds an array; returns its accessor. glTF requires the bounds of positions and times. */
    add(
        array: Float32Array | Uint32Array,
        type: "SCALAR" | "VEC3" | "VEC4",
        more: { target?: number; bounds?: true } = {},
    ): number {
        const { target, bounds } = more;
        const bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
        this.views.push({ buffer: 0, byteOffset: this.length, byteLength: bytes.length, ...(target && { target }) });
        this.parts.push(bytes);
        this.length += bytes.length;
        const size = { SCALAR: 1, VEC3: 3, VEC4: 4 }[type];
        const accessor = {
            bufferView: this.views.length - 1,
            componentType: array instanceof Uint32Array ? UNSIGNED_INT : FLOAT,
            count: array.length / size,
            type,
            ...(bounds && extent(array, size)),
        };
        return this.accessors.push(accessor) - 1;
    }
}

function extent(array: Float32Array | Uint32Array, size: number): { min: number[]; max: number[] } {
    const min = new Array<number>(size).fill(Number.POSITIVE_INFINITY);
    const max = new Array<number>(size).fill(Number.NEGATIVE_INFINITY);
    for (let i = 0; i < array.length; i++) {
        min[i % size] = Math.min(min[i % size], array[i]);
        max[i % size] = Math.max(max[i % size], array[i]);
    }
    return { min, max };
}

/** The morph targets of a mesh, and their weights. */
interface Morphs {
    base: Float32Array;
    targets(): { name: string; moves: Float32Array }[];
    /** Weights of the targets at rest. */
    rest: number[];
    /** Weights of all frames, for a body. */
    weights(body: MovingBody): Float32Array;
}

/** Given positions: the first frame, and a target for each further one. */
class GivenFrames implements Morphs {
    readonly base: Float32Array;
    readonly rest: number[];
    private readonly further: Float32Array[];

    constructor(positions: Float32Array, frames: number) {
        const size = positions.length / frames;
        const all = Array.from({ length: frames }, (_, f) => positions.subarray(f * size, (f + 1) * size));
        [this.base] = all;
        this.further = all.slice(1);
        this.rest = this.further.map(() => 0);
    }

    targets(): { name: string; moves: Float32Array }[] {
        const { base } = this;
        return this.further.map((x, i) => ({ name: `frame ${i + 1}`, moves: x.map((v, k) => v - base[k]) }));
    }

    weights(): Float32Array {
        const width = this.further.length;
        const weights = new Float32Array((width + 1) * width);
        for (let f = 1; f <= width; f++) weights[f * width + f - 1] = 1;
        return weights;
    }
}

/** The range of each mode of a shape over several tracks. */
class Range implements Morphs {
    readonly base: Float32Array;
    readonly rest: number[];
    private readonly low: number[];
    private readonly high: number[];
    private readonly moving: number[];

    constructor(
        private readonly shape: Shape,
        tracks: Float32Array[],
    ) {
        const { rank } = shape.model;
        const every = { length: rank };
        this.low = Array.from(every, () => Number.POSITIVE_INFINITY);
        this.high = Array.from(every, () => Number.NEGATIVE_INFINITY);
        for (const q of tracks) {
            for (let i = 0; i < q.length; i++) {
                this.low[i % rank] = Math.min(this.low[i % rank], q[i]);
                this.high[i % rank] = Math.max(this.high[i % rank], q[i]);
            }
        }
        this.moving = this.low.flatMap((low, k) => (low < this.high[k] ? [k] : []));
        this.base = shape.positions;
        this.rest = [1, ...this.moving.map(() => 0)];
    }

    targets(): { name: string; moves: Float32Array }[] {
        const { shape, low, high } = this;
        const size = shape.positions.length;
        const begin = shape.deformed(low).map((x, i) => x - shape.positions[i]);
        return [
            { name: "where it begins", moves: begin },
            ...this.moving.map((k) => ({
                name: shape.modeName(k),
                moves: shape.modes.subarray(k * size, (k + 1) * size).map((u) => u * (high[k] - low[k])),
            })),
        ];
    }

    weights({ q }: MovingBody): Float32Array {
        const { low, high, moving } = this;
        const { rank } = this.shape.model;
        const width = moving.length + 1;
        return Float32Array.from({ length: (q.length / rank) * width }, (_, i) => {
            if (i % width === 0) return 1;
            const k = moving[(i % width) - 1];
            const share = (q[Math.floor(i / width) * rank + k] - low[k]) / (high[k] - low[k]);
            return Math.min(Math.max(share, 0), 1);
        });
    }
}

export function writeGlb(bodies: MovingBody[], times: number[]): Blob {
    const buffer = new Buffer();
    const meshes: object[] = [];
    const known = new Map<Shape, { at: number; morphs: Morphs }>();
    const nodes: object[] = [];
    const roots: number[] = [];
    const samplers: object[] = [];
    const channels: object[] = [];
    const input = buffer.add(Float32Array.from(times), "SCALAR", { bounds: true });
    const animate = (node: number, path: string, output: number): void => {
        channels.push({
            sampler: samplers.push({ input, output, interpolation: "LINEAR" }) - 1,
            target: { node, path },
        });
    };
    for (const body of bodies) {
        const { name, shape, positions, rigid, center } = body;
        let moved = known.get(shape);
        if (!moved) {
            const tracks = bodies.filter((other) => other.shape === shape).map((other) => other.q);
            const morphs = positions ? new GivenFrames(positions, times.length) : new Range(shape, tracks);
            moved = { at: meshes.push(mesh(shape, morphs, buffer)) - 1, morphs };
            known.set(shape, moved);
        }
        const moves = positions ? center : rigid && center.map((c) => -c);
        const at = nodes.push({ name, mesh: moved.at, ...(moves && { translation: moves }) }) - 1;
        if (moved.morphs.rest.length > 0) animate(at, "weights", buffer.add(moved.morphs.weights(body), "SCALAR"));
        if (!rigid) {
            roots.push(at);
            continue;
        }
        const outer = nodes.push({ name: `${name}, as a whole`, children: [at] }) - 1;
        roots.push(outer);
        const pick = (from: number, size: number): Float32Array =>
            Float32Array.from(
                { length: times.length * size },
                (_, i) => rigid[7 * Math.floor(i / size) + from + (i % size)],
            );
        animate(outer, "translation", buffer.add(pick(0, 3), "VEC3"));
        animate(outer, "rotation", buffer.add(pick(3, 4), "VEC4"));
    }
    return pack(buffer, {
        asset: { version: "2.0", generator: "sscc" },
        scene: 0,
        scenes: [{ nodes: roots }],
        nodes,
        meshes,
        ...(channels.length > 0 && { animations: [{ name: "motion", samplers, channels }] }),
        accessors: buffer.accessors,
        bufferViews: buffer.views,
        buffers: [{ byteLength: buffer.length }],
    });
}

function mesh({ model, faces }: Shape, morphs: Morphs, buffer: Buffer): object {
    const points = (array: Float32Array): number =>
        buffer.add(array, "VEC3", { target: VERTEX_BUFFER, bounds: true });
    const targets = morphs.targets();
    const primitive = {
        attributes: { POSITION: points(morphs.base) },
        indices: buffer.add(faces, "SCALAR", { target: INDEX_BUFFER }),
        ...(targets.length > 0 && { targets: targets.map(({ moves }) => ({ POSITION: points(moves) })) }),
    };
    return {
        name: model.name,
        primitives: [primitive],
        ...(targets.length > 0 && { weights: morphs.rest, extras: { targetNames: targets.map((t) => t.name) } }),
    };
}

function pack(buffer: Buffer, json: object): Blob {
    const text = new TextEncoder().encode(JSON.stringify(json));
    const padded = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(0x20);
    padded.set(text);
    const head = new DataView(new ArrayBuffer(20));
    const words = [0x46546c67, 2, 28 + padded.length + buffer.length, padded.length, 0x4e4f534a];
    words.forEach((word, i) => {
        head.setUint32(4 * i, word, true);
    });
    const binary = new DataView(new ArrayBuffer(8));
    binary.setUint32(0, buffer.length, true);
    binary.setUint32(4, 0x004e4942, true);
    return new Blob([head, padded, binary, ...buffer.parts] as BlobPart[], { type: "model/gltf-binary" });
}
