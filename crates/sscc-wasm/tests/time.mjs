// Times of the package in Node beside those of the native command on one thread: node time.mjs PACKAGE [PASSES]. SSCC_COMMAND names the
// command of a release build. Prints CSV: for each kind of frame of `sscc demo` the mean time of a query (microseconds), of each side the
// smallest of all passes, and their ratio; the same of the certificates of its spring, which are computed once.
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { readRows, run } from "../../../viewer/tests/command.mjs";

const [, , folder, passes = "7"] = process.argv;
const { Certificates, Model, Query } = await import(pathToFileURL(resolve(folder, "node.js")));
const demo = mkdtempSync(join(tmpdir(), "sscc-wasm-time-"));
const file = (name) => join(demo, name);
/** As often does the demo ask a query that the root's radius answers. */
const REPETITIONS = 1000;

/** The kind of an answer, as the demo names it. */
function kind(pairs, statistics) {
    if (pairs.length > 0) return "colliding";
    return statistics.proof === "radius" ? "free by the root's certificate" : "free, root's certificate fails";
}

/** Asks for each frame once, as the demo does. Returns the times of each kind. */
function pass(model, certificates, rows) {
    const query = new Query(model, certificates);
    const times = new Map();
    for (const q of rows) {
        let start = process.hrtime.bigint();
        const pairs = query.discrete(q);
        let time = Number(process.hrtime.bigint() - start) / 1000;
        const name = kind(pairs, query.statistics);
        if (name.startsWith("free by")) {
            start = process.hrtime.bigint();
            for (let i = 0; i < REPETITIONS; i++) query.discrete(q);
            time = Number(process.hrtime.bigint() - start) / 1000 / REPETITIONS;
        }
        times.set(name, [...(times.get(name) ?? []), time]);
    }
    query.free();
    return times;
}

const native = new Map();
const module = new Map();
const keep = (least, name, time) => least.set(name, Math.min(time, least.get(name) ?? Infinity));
let frames;
// They take turns, so that both meet the same load of the machine.
for (let i = 0; i < Number(passes); i++) {
    ({ frames } = JSON.parse(await run("demo", "--out", demo, "--json")));
    for (const { group, certified_microseconds } of frames) keep(native, group, certified_microseconds);
    const model = Model.load(readFileSync(file("spring.model.safetensors")));
    const certificates = Certificates.load(readFileSync(file("spring.sscc.safetensors")));
    const rows = readRows(file("spring.npy")).map((row) => Float64Array.from(row));
    for (let again = 0; again < 3; again++) {
        for (const [name, times] of pass(model, certificates, rows)) {
            const wanted = frames.find(({ group }) => group === name)?.frames;
            if (times.length !== wanted) throw new Error(`${times.length} frames are ${name}, of the command ${wanted}`);
            keep(module, name, times.reduce((sum, time) => sum + time, 0) / times.length);
        }
    }
    model.free();
    certificates.free();
}

const model = Model.load(readFileSync(file("spring.model.safetensors")));
const start = process.hrtime.bigint();
const certificates = model.certify();
keep(module, "certificates", Number(process.hrtime.bigint() - start) / 1000);
const written = file("timed.sscc.safetensors");
const line = await run("certify", file("spring.model.safetensors"), "--threads", "1", "-o", written, "--json");
keep(native, "certificates", 1e6 * JSON.parse(line).seconds);
if (!readFileSync(written).equals(certificates.toBytes())) throw new Error("other certificates than the command");
rmSync(demo, { recursive: true, force: true });

console.log("what,native_microseconds,wasm_microseconds,ratio");
for (const [name, time] of module) {
    const other = native.get(name);
    console.log(`"${name}",${other.toPrecision(4)},${time.toPrecision(4)},${(time / other).toFixed(2)}`);
}
