// A generated scene: three falling tubes with four modes, one contact in the middle, one between two frames, a tone.
const RINGS = 60;
const SIDES = 16;

/** Little-endian bytes of an array, in base64. */
export function base64(array) {
    return Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString("base64");
}

/** A tube along x from -1 to 1, and its modes. */
export function tube() {
    const positions = [];
    for (let i = 0; i < RINGS; i++) {
        for (let j = 0; j < SIDES; j++) {
            const angle = (2 * Math.PI * j) / SIDES;
            positions.push(-1 + (2 * i) / (RINGS - 1), 0.14 * Math.cos(angle), 0.14 * Math.sin(angle));
        }
    }
    const faces = [];
    for (let i = 0; i + 1 < RINGS; i++) {
        for (let j = 0; j < SIDES; j++) {
            const [a, b] = [i * SIDES + j, i * SIDES + ((j + 1) % SIDES)];
            faces.push(a, a + SIDES, b, b, a + SIDES, b + SIDES);
        }
    }
    const shapes = [
        (x) => [0, x * x, 0],
        (x) => [0, 0, x * x],
        (x) => [0, Math.sin(2 * Math.PI * x) / 2, 0],
        (x) => [x * 0.5, 0, 0],
    ];
    const modes = shapes.flatMap((shape) => {
        const mode = [];
        for (let v = 0; v < positions.length; v += 3) mode.push(...shape(positions[v]));
        return mode;
    });
    return { positions: new Float32Array(positions), faces: new Uint32Array(faces), modes: new Float32Array(modes) };
}

/** A tone of 16-bit samples, as WAV. */
function tone(seconds, rate = 8000) {
    const n = Math.round(seconds * rate);
    const wav = Buffer.alloc(44 + 2 * n);
    wav.write("RIFF", 0);
    wav.writeUInt32LE(36 + 2 * n, 4);
    wav.write("WAVEfmt ", 8);
    wav.writeUInt32LE(16, 16);
    wav.writeUInt16LE(1, 20);
    wav.writeUInt16LE(1, 22);
    wav.writeUInt32LE(rate, 24);
    wav.writeUInt32LE(2 * rate, 28);
    wav.writeUInt16LE(2, 32);
    wav.writeUInt16LE(16, 34);
    wav.write("data", 36);
    wav.writeUInt32LE(2 * n, 40);
    for (let i = 0; i < n; i++)
        wav.writeInt16LE(Math.round(3000 * Math.sin((i * 440 * 2 * Math.PI) / rate)), 44 + 2 * i);
    return wav;
}

const FRAMES = 60;
const BODIES = 3;

/** A report; `change` may modify its scene and arrays. With `flight` the bodies fly as many times as far. `checks`: see protocol.ts. */
export function report({ sound = false, playback = true, flight = 1, checks, change = () => {} } = {}) {
    const { positions, faces, modes } = tube();
    const times = Array.from({ length: FRAMES }, (_, t) => t / 30);
    const arrays = { p: base64(positions), f: base64(faces), u: base64(modes) };
    const bodies = [];
    const offsets = [0];
    const triangles = [];
    for (let b = 0; b < BODIES; b++) {
        const q = [];
        const rigid = [];
        const pairs = [];
        times.forEach((time, t) => {
            q.push(0.4 * Math.sin(6 * time + b), 0, 0.2 * Math.cos(5 * time), 0);
            const turn = time * (0.4 + 0.2 * b);
            const height = 1.6 - 0.35 * flight * time * time;
            rigid.push(1.2 * (b - 1) + (flight - 1) * time, 0, height, 0, 0, Math.sin(turn / 2), Math.cos(turn / 2));
            pairs.push(b === 1 && t >= 20 && t < 30 ? t - 15 : 0);
        });
        arrays[`q${b}`] = base64(new Float32Array(q));
        arrays[`r${b}`] = base64(new Float32Array(rigid));
        bodies.push({ name: `tube ${b + 1}`, model: 0, q: `q${b}`, rigid: `r${b}`, center: [0, 0, 0], pairs });
    }
    for (let t = 0; t < FRAMES; t++) {
        for (let b = 0; b < BODIES; b++) {
            if (bodies[b].pairs[t] > 0) for (let k = 0; k < 40; k++) triangles.push(900 + k);
            offsets.push(triangles.length);
        }
    }
    arrays.offsets = base64(new Uint32Array(offsets));
    arrays.triangles = base64(new Uint32Array(triangles));
    if (sound) arrays.sound = tone(2).toString("base64");
    const levels = [0, 1, 2, 3, 4, 5].map((level) => ({
        level,
        nodes: 4 ** level,
        least: 0.1 * 1.1 ** level,
        median: 0.1 * 1.3 ** level,
        largest: 0.1 * 1.6 ** level,
        capped: 0,
    }));
    const scene = {
        title: "Three tubes fall",
        version: "0.1.0",
        models: [
            {
                name: "tube",
                triangles: faces.length / 3,
                vertices: positions.length / 3,
                rank: 4,
                arrays: { positions: "p", faces: "f", modes: "u" },
                box: { min: [-1, -0.14, -0.14], max: [1, 0.14, 0.14] },
                frequencies: [110, 110, 275, 1200],
                mode_names: null,
                scales: [1, 1, 2, 3],
                center: [0, 0, 0, 0],
                default_q: [0, 0, 0, 0],
                limits: [1, 1, 1, 1],
                root_radius: 0.1,
                global_radius: 1.4,
                resolved_up_to: 0.4,
                metric: "energy",
                exceptions: 0,
                nodes: 1365,
                levels,
                extremal: [0, 1, 2, 3].map((k) => ({
                    name: `mode ${k} +`,
                    q: [0, 1, 2, 3].map((i) => (i === k ? 0.8 : 0)),
                })),
            },
        ],
        plots: [
            {
                title: "Energy and displacement",
                x: { label: "amplitude", log: true },
                y: { label: "cost (s)", log: true },
                series: [
                    { name: "energy metric", x: [0.01, 0.1, 1, 10], y: [1e-7, 1e-6, 1e-4, 2e-3] },
                    { name: "displacement metric", x: [0.01, 0.1, 1, 10], y: [1e-7, 2e-5, 8e-4, 2e-3] },
                ],
            },
        ],
        playback: playback
            ? {
                  times,
                  bodies,
                  pairs_since: times.map((_, t) => (t === 40 ? 2922 : t > 20 && t <= 30 ? t - 15 : 0)),
                  colliding: { offsets: "offsets", triangles: "triangles" },
                  ground: 0,
                  sound: sound ? "sound" : null,
                  costs: {
                      title: "Cost over time",
                      x: { label: "time (s)", log: false },
                      y: { label: "seconds for a step", log: true },
                      series: [
                          { name: "sscc", x: times, y: times.map((t) => 1e-6 * (1 + t)) },
                          { name: "traditional", x: times, y: times.map((t) => 2e-3 + 1e-4 * Math.sin(9 * t)) },
                      ],
                  },
              }
            : null,
        summary: [
            ["triangles", "1,888"],
            ["frames", String(FRAMES)],
        ],
    };
    change(scene, arrays);
    return { scene, arrays, checks };
}

/** Inserts a report into the page, as the program does. */
export function withReport(page, data) {
    const empty = '<script type="application/json" id="sscc-report">null</script>';
    if (page.split(empty).length !== 2) throw new Error("the page must have one element for its report");
    const json = JSON.stringify(data).replaceAll("<", "\\u003c");
    return page.replace(empty, () => empty.replace("null", () => json));
}
