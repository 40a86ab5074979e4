// Runs the programs in docs/wasm.md and in the package's README. SSCC_PACKAGE is the package's folder.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";

const docs = new URL("../../../docs/wasm.md", import.meta.url);
const readme = new URL("../npm/README.md", import.meta.url);
const folder = mkdtempSync(join(tmpdir(), "sscc-wasm-docs-"));
mkdirSync(join(folder, "node_modules"));
symlinkSync(process.env.SSCC_PACKAGE, join(folder, "node_modules/sscc"), "junction");
after(() => rmSync(folder, { recursive: true, force: true }));

function run(program) {
    const path = join(folder, "program.mjs");
    writeFileSync(path, program);
    return execFileSync(process.execPath, [path], { encoding: "utf8" });
}

test("the programs of the document print what it shows", () => {
    const shown = [...readFileSync(docs, "utf8").matchAll(/```js\n(.*?)```\n\n```text\n(.*?)```/gs)];
    assert.equal(shown.length, 2);
    for (const [, program, output] of shown) assert.equal(run(program), output);
});

test("the program of the README runs", () => {
    const [, program] = /```js\n(.*?)```/s.exec(readFileSync(readme, "utf8"));
    const bytes = `import { readFileSync } from "node:fs";\nconst bytes = readFileSync(${JSON.stringify(join(process.env.SSCC_DIGESTS, "strips.model"))});\n`;
    assert.equal(run(bytes + program.replace(/(query\.discrete.*);/, "console.log($1.length);")), "0\n");
});
