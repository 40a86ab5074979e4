/** Writes a motion as GLB: modes as morph targets, q(t) as their weights, rigid motion on the nodes. */
import type { Shape } from "./shape";

export interface Moved {
    name: string;
    shape: Shape;
    /** Row after row. */
    q: Float32Array;
    /** x y z and a quaternion x y z w for each row. */
    rigid: Float32Array | null;
    center: number[];
}

const FLOAT = 5126;
const UNSIGNED_INT = 5125;
const VERTEX_BUFFER = 34962;
const INDEX_BUFFER = 34963;

/** The pieces of the one buffer, and what describes them. */
class Buffer {
    readonly views: object[] = [];
    readonly accessors: object[] = [];
    readonly parts: Uint8Array[] = [];
    length = 0;

    /** An accessor over all of an array; glTF wants the bounds of positions and times. */
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

export function writeGlb(bodies: Moved[], times: number[]): Blob {
    const buffer = new Buffer();
    const meshes: object[] = [];
    const meshOf = new Map<Shape, number>();
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
    for (const { name, shape, q, rigid, center } of bodies) {
        if (!meshOf.has(shape)) meshOf.set(shape, meshes.push(mesh(shape, buffer)) - 1);
        const inner = { name, mesh: meshOf.get(shape), ...(rigid && { translation: center.map((c) => -c) }) };
        const at = nodes.push(inner) - 1;
        animate(at, "weights", buffer.add(q, "SCALAR"));
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
        animations: [{ name: "motion", samplers, channels }],
        accessors: buffer.accessors,
        bufferViews: buffer.views,
        buffers: [{ byteLength: buffer.length }],
    });
}

function mesh(shape: Shape, buffer: Buffer): object {
    const { model, positions, faces, modes } = shape;
    const points = (array: Float32Array): number =>
        buffer.add(array, "VEC3", { target: VERTEX_BUFFER, bounds: true });
    const names = Array.from({ length: model.rank }, (_, k) => shape.modeName(k));
    const primitive = {
        attributes: { POSITION: points(positions) },
        indices: buffer.add(faces, "SCALAR", { target: INDEX_BUFFER }),
        targets: names.map((_, k) => ({
            POSITION: points(modes.subarray(k * positions.length, (k + 1) * positions.length)),
        })),
    };
    return { name: model.name, primitives: [primitive], weights: names.map(() => 0), extras: { targetNames: names } };
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
