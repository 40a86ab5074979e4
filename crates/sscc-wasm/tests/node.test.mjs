// Tests of the package in Node. SSCC_PACKAGE is its folder, SSCC_DIGESTS that of the native bytes.
import assert from "node:assert/strict";
import { once } from "node:events";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { runInNewContext } from "node:vm";
import { Worker } from "node:worker_threads";
import { compare } from "./models.mjs";

const folder = process.env.SSCC_PACKAGE;
const { exports } = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
const url = pathToFileURL(join(folder, exports["."].node));
const sscc = await import(url);
await sscc.default();
const { Certificates, Detector, Model, Query } = sscc;

/** Two triangles above each other, and a mode that moves the upper one along z. */
const positions = Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1);
const faces = Uint32Array.of(0, 1, 2, 3, 4, 5);
const modes = Float64Array.from({ length: 18 }, (_, row) => (row >= 9 && row % 3 === 2 ? 1 : 0));
const two = () => new Model(positions, faces, modes);

test("certificates and answers of five models have the native bytes", async () => {
    const read = async (name) => new Uint8Array(readFileSync(join(process.env.SSCC_DIGESTS, name)));
    assert.deepEqual(await compare(sscc, read), { models: 5, differences: [] });
});

test("a model is made, certified, stored and queried", () => {
    const model = two();
    assert.deepEqual([model.vertexCount, model.triangleCount, model.rank], [6, 2, 1]);
    const certificates = model.certify();
    const query = new Query(Model.load(model.toBytes()), Certificates.load(certificates.toBytes()));
    assert.deepEqual([...query.discrete(Float64Array.of(-1))], [0, 1]);
    assert.equal(query.isColliding([-1]), true);
    assert.equal(query.count([-1]), 1);
    for (const [limit, pairs] of [[0, []], [1, [0, 1]], [2 ** 32, [0, 1]], [Infinity, [0, 1]], [undefined, [0, 1]]]) {
        assert.deepEqual([...query.discreteAtMost([-1], limit)], pairs, `${limit}`);
        assert.equal(query.statistics.complete, pairs.length > 0, `${limit}`);
    }
    assert.deepEqual([...query.discrete([-0.5])], []);
    const { statistics } = query;
    assert.deepEqual([statistics.complete, statistics.rootCertified, statistics.proof], [true, true, "radius"]);
    assert.ok(statistics.norm < certificates.rootRadius);
    assert.ok(certificates.norm([-0.5]) === statistics.norm);
    const impacts = query.continuous([0], [-2]);
    assert.deepEqual([...impacts.pairs], [0, 1]);
    assert.ok(Math.abs(impacts.times[0] - 0.5) < 1e-9);
    assert.ok(query.safeScale([-2]) <= 0.5);
});

test("a batch has the answers of its q", () => {
    const model = two();
    const query = new Query(model, model.certify());
    const batch = query.batch([-0.5, -1, -3, -1]);
    assert.equal(batch.count, 4);
    assert.deepEqual([...batch.offsets], [0, 0, 1, 1, 2]);
    assert.deepEqual([...batch.pairs], [0, 1, 0, 1]);
    assert.equal(query.batch([]).count, 0);
    // Arrays are copied once, and stay when the answer is freed.
    const impacts = query.continuous([0], [-2]);
    for (const [answer, names] of [[batch, ["pairs", "offsets"]], [impacts, ["pairs", "times"]]]) {
        const arrays = names.map((name) => answer[name]);
        answer.free();
        names.forEach((name, i) => assert.equal(answer[name], arrays[i]));
    }
    const [freed, other] = [query.batch([-1]), query.batch([-3])];
    assert.notEqual(freed.pairs.length, other.pairs.length);
    freed.free();
    assert.throws(() => freed.offsets, /null pointer/);
});

test("typed arrays, other arrays and freed queries have the answers and errors that one expects", () => {
    const model = two();
    const query = new Query(model, model.certify());
    for (const [number, pairs] of [[-0.5, []], [-1, [0, 1]], [-3, []]]) {
        for (const q of [[number], Float64Array.of(number), Float32Array.of(number), new Float64Array([9, number]).subarray(1)]) {
            assert.deepEqual(query.discrete(q), Uint32Array.from(pairs));
            assert.equal(query.count(q), pairs.length / 2);
            assert.equal(query.isColliding(q), pairs.length > 0);
        }
    }
    // An answer without pairs can be transferred to another thread, as can any other.
    for (let i = 0; i < 3; i++) {
        const found = query.discrete(Float64Array.of(-0.5));
        assert.deepEqual([found.length, found.buffer.byteLength], [0, 0]);
        structuredClone(found, { transfer: [found.buffer] });
    }
    // Views of the memory are created again after the memory has grown.
    const { memory } = sscc.initSync();
    const before = memory.buffer.byteLength;
    const large = Array.from({ length: 8 }, () => new Detector(new Float64Array(900_000), Uint32Array.of(0, 1, 2)));
    assert.ok(memory.buffer.byteLength > before);
    assert.deepEqual(query.discrete(Float64Array.of(-1)), Uint32Array.of(0, 1));
    for (const detector of large) detector.free();
    query.free();
    for (const act of [(q) => query.discrete(q), (q) => query.count(q), (q) => query.isColliding(q)])
        for (const q of [[-1], Float64Array.of(-1)]) assert.throws(() => act(q), /null pointer/);
});

test("a centre may be a typed array", () => {
    const bytes = (center) => two().certify({ center }).toBytes();
    assert.deepEqual(bytes(Float64Array.of(0.25)), bytes([0.25]));
    assert.notDeepEqual(bytes([0.25]), bytes([0]));
});

test("options are plain objects of any realm", () => {
    const bytes = (options) => two().certify(options).toBytes();
    const moved = bytes({ center: [0.25] });
    assert.notDeepEqual(moved, bytes());
    assert.deepEqual(bytes(Object.assign(Object.create(null), { center: [0.25] })), moved);
    assert.deepEqual(bytes(runInNewContext("({ center: [0.25] })")), moved);
});

test("a detector needs no modes", () => {
    const detector = new Detector(positions, faces);
    assert.deepEqual([...detector.discrete(positions)], []);
    const model = two();
    const touching = model.positions([-1]);
    assert.deepEqual([...detector.discrete(touching)], [0, 1]);
    assert.deepEqual([...detector.discreteAtMost(touching, 1)], [0, 1]);
    assert.deepEqual([...detector.continuous(positions, model.positions([-3])).pairs], [0, 1]);
    // A quad folded flat: its triangles have two vertices in common.
    const folded = Float64Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2, 0.2, 0);
    const quad = Uint32Array.of(0, 1, 2, 1, 0, 3);
    assert.equal(new Detector(folded, quad).discrete(folded).length, 0);
    assert.equal(new Detector(folded, quad, { neighbours: "include-folded" }).discrete(folded).length, 2);
});

test("bad input is an error of one line, and the module goes on", () => {
    const model = two();
    const query = new Query(model, model.certify());
    const other = new Model(positions, faces, modes.map((u) => 2 * u));
    for (const [act, cause] of [
        [() => new Model(positions.subarray(1), faces, modes), /positions has 17 numbers/],
        [() => new Model(positions, [0, 1], modes), /faces has 2 numbers/],
        [() => new Model(positions, [0, 1, 9], modes), /9/],
        [() => new Model(positions, [0, 1, Number.NaN], modes), /faces\[2\] is NaN; it must be a vertex number/],
        [() => new Model(positions, [0, 1.9, 2], modes), /faces\[1\] is 1.9;/],
        [() => new Model(positions, [4294967296, 1, 2], modes), /faces\[0\] is 4294967296;/],
        [() => new Detector(positions, [0, 1, -1]), /faces\[2\] is -1;/],
        [() => query.discreteAtMost([-1], Number.NaN), /the limit is NaN/],
        [() => query.discreteAtMost([-1], -1), /the limit is -1/],
        [() => new Detector(positions, faces).discreteAtMost(positions, 0.5), /the limit is 0.5/],
        [() => new Model(positions, faces, modes.subarray(1)), /modes has 17 numbers/],
        [() => new Model(positions, faces, []), /mode/],
        [() => new Model([Number.NaN, ...positions.subarray(1)], faces, modes), /NaN|finite/],
        [() => Model.load(new Uint8Array(0)), /./],
        [() => Model.load(model.toBytes().subarray(0, 100)), /./],
        [() => Model.load(model.toBytes(), "Mesh"), /meshName/],
        [() => Model.load(new TextEncoder().encode('{"asset":{"version":"2.0"}}')), /./],
        [() => Certificates.load(model.toBytes()), /./],
        [() => model.certify({ neighbour: "exclude" }), /options: unknown field `neighbour`/],
        [() => model.certify({ neighbours: "all" }), /include-one-vertex/],
        [() => model.certify({ epsilon: 2 }), /epsilon/],
        [() => model.certify({ epsilon: Number.NaN }), /options: epsilon is NaN: it must be finite/],
        [() => model.certify({ reach: Infinity }), /options: reach is inf/],
        [() => model.certify({ epsilon: () => 0.1 }), /options: epsilon is no value/],
        [() => model.certify({ center: [1, 2] }), /1/],
        [() => model.certify({ center: Float64Array.of(1, 2) }), /1/],
        [() => model.certify({ center: Float64Array.of(Number.NaN) }), /options: item 0 of an array is NaN/],
        [() => model.certify([]), /options: it is no plain object/],
        [() => model.certify(Number.NaN), /options: it is no plain object/],
        [() => model.certify("paper"), /options: it is no plain object/],
        [() => model.certify(() => 1), /options: it is no plain object/],
        [() => model.certify(null), /options: it is no plain object/],
        [() => model.certify(new Map([["epsilon", 0.5]])), /options: it is no plain object/],
        [() => model.certify(new Set(["paper"])), /options: it is no plain object/],
        [() => model.certify(runInNewContext("new Map([['epsilon', 0.5]])")), /options: it is no plain object/],
        [() => model.certify(Object.create({ epsilon: 0.5 })), /options: it is no plain object/],
        [() => new Detector(positions, faces, new Map([["weld", true]])), /options: it is no plain object/],
        [() => new Query(other, model.certify()), /another model|other model/],
        [() => query.discrete([]), /0/],
        [() => query.discrete([Number.NaN]), /NaN/],
        [() => query.discrete(new Float64Array(2)), /2/],
        [() => query.discrete(Float64Array.of(Number.NaN)), /NaN/],
        [() => query.count(Float64Array.of(Infinity)), /inf/],
        [() => query.isColliding(new Float64Array(0)), /0/],
        [() => query.batch([-1, Number.NaN, 0]), /q number 1 of the batch: .*NaN/],
        [() => new Detector(positions, faces, { epsilon: 0.1 }), /options: a detector/],
        [() => new Detector(positions, faces).discrete(positions.subarray(3)), /5|15/],
    ]) {
        assert.throws(act, (error) => {
            assert.ok(error instanceof Error && !(error instanceof WebAssembly.RuntimeError), `${act}: ${error}`);
            assert.match(error.message, cause, `${act}`);
            assert.ok(!error.message.includes("\n"), error.message);
            return true;
        });
    }
    assert.deepEqual([...query.discrete([-1])], [0, 1]);
});

test("memory that is freed is used again", () => {
    const model = two();
    const query = new Query(model, model.certify());
    const { memory } = sscc.initSync();
    const before = memory.buffer.byteLength;
    for (let i = 0; i < 20_000; i++) query.discrete([-1]);
    for (let i = 0; i < 200; i++) {
        const [made, detector] = [two(), new Detector(positions, faces)];
        made.free();
        detector.free();
    }
    assert.ok(memory.buffer.byteLength <= before + 131_072, `${before} to ${memory.buffer.byteLength} bytes`);
});

test("each worker has a module of its own", async () => {
    const program = `
        import { parentPort, workerData } from "node:worker_threads";
        const { Detector, initSync } = await import(workerData);
        const { memory } = initSync();
        const before = memory.buffer.byteLength;
        const detectors = Array.from({ length: 8 }, () => new Detector(new Float64Array(900_000), Uint32Array.of(0, 1, 2)));
        parentPort.postMessage([detectors.length, before, memory.buffer.byteLength]);`;
    const sizes = async () => {
        const worker = new Worker(new URL(`data:text/javascript,${encodeURIComponent(program)}`), { workerData: url.href });
        const [sizes] = await once(worker, "message");
        await worker.terminate();
        return sizes;
    };
    const own = sscc.initSync().memory.buffer.byteLength;
    const [first, second] = [await sizes(), await sizes()];
    assert.ok(first[0] === 8 && first[1] < first[2], `${first}`);
    assert.deepEqual(second, first);
    assert.equal(sscc.initSync().memory.buffer.byteLength, own);
});
