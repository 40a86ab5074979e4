// The process in Node of `benches/wasm_against_native.rs`: node time.mjs PACKAGE DIR REPETITIONS, where DIR contains the files of
// `sscc demo --out`. Each line of its input is `frames` or `certificates`; the answer is a line of JSON with nanoseconds.
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { createInterface } from "node:readline";
import { pathToFileURL } from "node:url";
import { readRows } from "../../../viewer/tests/command.mjs";

const [, , folder, demo, count] = process.argv;
const repetitions = Number(count);
const { Certificates, Model, Query } = await import(pathToFileURL(resolve(folder, "node.js")));
const file = (name) => readFileSync(join(demo, name));
const model = Model.load(file("spring.model.safetensors"));
const query = new Query(model, Certificates.load(file("spring.sscc.safetensors")));
const frames = readRows(join(demo, "spring.npy")).map((row) => Float64Array.from(row));
/** Each frame, repeated, as one batch. */
const batches = new Map(frames.map((q) => [q, Float64Array.from({ length: repetitions * q.length }, (_, i) => q[i % q.length])]));

function time(ask, times) {
    const start = process.hrtime.bigint();
    for (let i = 0; i < times; i++) ask();
    return Number(process.hrtime.bigint() - start) / times;
}

/** Asks for each frame, one after the other as in an animation. */
function timesOfFrames() {
    const times = { radius: [], "radius, isColliding": [], "radius, batch": [], free: [], colliding: [] };
    for (const q of frames) {
        let pairs;
        const once = time(() => (pairs = query.discrete(q)), 1);
        if (pairs.length > 0) times.colliding.push(once);
        else if (query.statistics.proof !== "radius") times.free.push(once);
        else {
            times.radius.push(time(() => query.discrete(q), repetitions));
            times["radius, isColliding"].push(time(() => query.isColliding(q), repetitions));
            times["radius, batch"].push(time(() => query.batch(batches.get(q)).free(), 4) / repetitions);
        }
    }
    return times;
}

/** Computes certificates once, in processor time of the process. */
function timeOfCertificates() {
    const start = process.cpuUsage();
    model.certify().free();
    const { user, system } = process.cpuUsage(start);
    return { certificates: [1000 * (user + system)] };
}

for await (const line of createInterface({ input: process.stdin }))
    console.log(JSON.stringify(line === "frames" ? timesOfFrames() : timeOfCertificates()));
