// A generated rig with morph targets, as glTF: a ball, and two walls with blades that move through them, behind the ball and within it.
import { base64 } from "./fixture.mjs";

const RINGS = 16;
const SIDES = 24;
/** The blade of each pair is this far from its wall. */
const GAP = 0.1;

/** Names of the targets that move the blades. The blades touch their walls at the weights 0.5 and 0.25. */
export const BEHIND = "the_blade_behind_the_ball_moves_through_its_wall_and_beyond_L";
export const WITHIN = "within the ball: blade → wall";

/** A ball of radius 1 and the walls and blades; returns also the first vertex of each blade, and the number of vertices of the ball. */
function shape() {
    const positions = [
        [0, 1, 0],
        [0, -1, 0],
    ];
    const faces = [];
    for (let i = 1; i < RINGS; i++) {
        for (let j = 0; j < SIDES; j++) {
            const [a, b] = [(Math.PI * i) / RINGS, (2 * Math.PI * j) / SIDES];
            positions.push([Math.sin(a) * Math.cos(b), Math.cos(a), Math.sin(a) * Math.sin(b)]);
        }
    }
    const at = (i, j) => (i === 0 ? 0 : i === RINGS ? 1 : 2 + (i - 1) * SIDES + (j % SIDES));
    for (let i = 0; i < RINGS; i++) {
        for (let j = 0; j < SIDES; j++) {
            if (i > 0) faces.push([at(i, j), at(i, j + 1), at(i + 1, j)]);
            if (i + 1 < RINGS) faces.push([at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        }
    }
    const inBall = positions.length;
    const sheet = (corners) => {
        const first = positions.length;
        positions.push(...corners);
        faces.push([first, first + 1, first + 2], [first, first + 2, first + 3]);
        return first;
    };
    // A wall, and a blade whose edge is at the distance GAP.
    const moving = [-1.3, 0].map((z) => {
        const square = [
            [-1, -1],
            [1, -1],
            [1, 1],
            [-1, 1],
        ];
        sheet(square.map(([u, v]) => [GAP / 2, 0.1 * u, z + 0.1 * v]));
        return sheet(square.map(([u, v]) => [-GAP / 2 - 0.06 * (u + 1), 0.01 * u, z + 0.08 * v]));
    });
    return { positions, faces, moving, inBall };
}

/** A glTF file with `bulges` more targets that move the ball a little and collide with nothing. */
export function rig(bulges) {
    const { positions, faces, moving, inBall } = shape();
    const still = positions.map(() => [0, 0, 0]);
    const blade = (first, speed) => still.map((x, v) => (v >= first && v < first + 4 ? [speed, 0, 0] : x));
    const targets = [
        [BEHIND, blade(moving[0], GAP / 0.5)],
        [WITHIN, blade(moving[1], GAP / 0.25)],
        ...Array.from({ length: bulges }, (_, k) => {
            const moves = (v) => v < inBall && v % (k + 2) === 0;
            return [
                `bulge_number_${k + 1}_of_the_ball`,
                positions.map((x, v) => (moves(v) ? x.map((c) => 0.01 * c) : [0, 0, 0])),
            ];
        }),
    ];
    const parts = [positions, ...targets.map(([, moves]) => moves)].map((x) => new Float32Array(x.flat()));
    const index = new Uint32Array(faces.flat());
    const bytes = [...parts, index].map((part) => Buffer.from(part.buffer, part.byteOffset, part.byteLength));
    let offset = 0;
    const bufferViews = bytes.map((part) => {
        const view = { buffer: 0, byteOffset: offset, byteLength: part.length };
        offset += part.length;
        return view;
    });
    const vectors = parts.map((part, i) => ({
        bufferView: i,
        componentType: 5126,
        count: part.length / 3,
        type: "VEC3",
    }));
    const indices = { bufferView: parts.length, componentType: 5125, count: index.length, type: "SCALAR" };
    const primitive = {
        attributes: { POSITION: 0 },
        indices: parts.length,
        targets: targets.map((_, k) => ({ POSITION: k + 1 })),
    };
    return JSON.stringify({
        asset: { version: "2.0" },
        buffers: [
            { byteLength: offset, uri: `data:application/octet-stream;base64,${base64(Buffer.concat(bytes))}` },
        ],
        bufferViews,
        accessors: [...vectors, indices],
        meshes: [{ name: "rig", primitives: [primitive], extras: { targetNames: targets.map(([name]) => name) } }],
        nodes: [{ mesh: 0 }],
        scenes: [{ nodes: [0] }],
        scene: 0,
    });
}
