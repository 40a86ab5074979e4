// Times of the package in Node and of the native command on one thread, for a model with certificates and a motion:
// node time.mjs PACKAGE FOLDER, where FOLDER is that of `sscc demo --out`, and SSCC_COMMAND names the command of a release build.
// Prints CSV: of each kind of frame the number, the mean of the smallest times of its frames (microseconds), and their ratio.
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { readRows, run } from "../../../viewer/tests/command.mjs";

const [folder, demo] = process.argv.slice(2).map((path) => resolve(path));
const { Certificates, Model, Query } = await import(pathToFileURL(join(folder, "node.js")));
const [modelPath, certificatesPath, motion] = ["spring.model.safetensors", "spring.sscc.safetensors", "spring.npy"].map(
    (name) => join(demo, name),
);
const REPEATS = 9;
const rows = readRows(motion).map((row) => Float64Array.from(row));
const model = Model.load(readFileSync(modelPath));
const query = new Query(model, Certificates.load(readFileSync(certificatesPath)));

const [native, module] = [rows.map(() => Infinity), rows.map(() => Infinity)];
let answers;
// The two take turns, so that both meet the same load of the machine.
for (let repeat = 0; repeat < REPEATS; repeat++) {
    const command = ["check", modelPath, "--certificates", certificatesPath, "--trajectory", motion, "--json"];
    answers = (await run(...command)).trim().split("\n").map((line) => JSON.parse(line));
    for (const [i, answer] of answers.entries()) native[i] = Math.min(native[i], answer.microseconds);
    for (const [i, q] of rows.entries()) {
        const start = process.hrtime.bigint();
        const pairs = query.discrete(q);
        module[i] = Math.min(module[i], Number(process.hrtime.bigint() - start) / 1000);
        if (pairs.length !== 2 * answers[i].count) throw new Error(`frame ${i}: other pairs than the command`);
    }
}

async function certify() {
    const start = process.hrtime.bigint();
    const certificates = model.certify();
    const seconds = Number(process.hrtime.bigint() - start) / 1e9;
    const path = join(demo, "timed.sscc.safetensors");
    const line = await run("certify", modelPath, "--threads", "1", "-o", path, "--json");
    if (!readFileSync(path).equals(certificates.toBytes())) throw new Error("other certificates than the command");
    return [JSON.parse(line).seconds, seconds];
}

console.log("what,frames,native_microseconds,wasm_microseconds,ratio");
for (const [what, wanted] of [
    ["free by the root's certificate", (a) => a.root_certified],
    ["free, root's certificate fails", (a) => !a.root_certified && !a.colliding],
    ["colliding", (a) => a.colliding],
]) {
    const frames = answers.flatMap((answer, i) => (wanted(answer) ? [i] : []));
    const mean = (times) => frames.reduce((sum, i) => sum + times[i], 0) / frames.length;
    const [a, b] = [mean(native), mean(module)];
    console.log(`"${what}",${frames.length},${a.toPrecision(4)},${b.toPrecision(4)},${(b / a).toFixed(2)}`);
}
const [a, b] = (await certify()).map((seconds) => 1e6 * seconds);
console.log(`certificates,1,${a.toPrecision(4)},${b.toPrecision(4)},${(b / a).toFixed(2)}`);
