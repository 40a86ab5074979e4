// Tests the types of the package by a program in TypeScript, checked by the compiler of viewer/. SSCC_PACKAGE is the package's folder.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath } from "node:url";

const compiler = fileURLToPath(new URL("../../../viewer/node_modules/typescript/bin/tsc", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "sscc-wasm-types-"));
mkdirSync(join(folder, "node_modules"));
symlinkSync(process.env.SSCC_PACKAGE, join(folder, "node_modules/sscc"), "junction");
after(() => rmSync(folder, { recursive: true, force: true }));

const PROGRAM = `
import init, { type Batch, type CertifyOptions, Certificates, Detector, Model, Query } from "sscc";

await init();
const x = new Float64Array(18);
const model: Model = new Model(x, new Uint32Array(6), x);
const options: CertifyOptions = { neighbours: "include-one-vertex", weld: true, scheme: "paper", center: new Float64Array(1), ignoreRest: 1 };
const certificates: Certificates = model.certify(options);
const names: string[] = model.modeNames;
const q: Float64Array = model.defaultQ ?? new Float64Array(model.rank);
const query = new Query(model, certificates);
const pairs: Uint32Array = query.discrete(q);
const some: Uint32Array[] = [query.discreteAtMost(q, Infinity), query.discreteAtMost(q)];
const batch: Batch = query.batch(q);
const offsets: Uint32Array = batch.offsets;
// @ts-expect-error A part of the package that only its own script uses.
query.addressOfQ(1);
const proof: "radius" | "local" | "search" = query.statistics.proof;
const times: Float64Array = query.continuous(q, q).times;
const plain = new Detector(x, [0, 1, 2]);
const detector = new Detector(x, new Uint32Array(6), { neighbours: "include-folded" });
// @ts-expect-error An option that does not exist.
model.certify({ neighbour: "exclude" });
// @ts-expect-error A value that does not exist.
new Detector(x, new Uint32Array(6), { neighbours: "all" });
// @ts-expect-error A detector does not have the options of certificates.
new Detector(x, new Uint32Array(6), { epsilon: 0.1 });
// @ts-expect-error Certificates are computed or loaded.
new Certificates();
export { detector, names, offsets, pairs, plain, proof, some, times };
`;

test("a program with the types of the package is checked", () => {
    const path = join(folder, "program.mts");
    writeFileSync(path, PROGRAM);
    const flags = ["--noEmit", "--strict", "--target", "es2022", "--lib", "es2022,dom,esnext.disposable"];
    const { status, stdout, stderr } = spawnSync(
        process.execPath,
        [compiler, ...flags, "--module", "nodenext", "--types", "", path],
        { cwd: folder, encoding: "utf8" },
    );
    assert.equal(status, 0, stdout + stderr);
});
