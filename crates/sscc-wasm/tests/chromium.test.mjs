// Tests of the package in Chromium, and of a report that checks shapes without a network. SSCC_PACKAGE is the package's folder,
// SSCC_DIGESTS that of the native bytes.
import assert from "node:assert/strict";
import { copyFileSync, mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { dirname, extname, join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { answered, launch, open } from "../../../viewer/tests/browser.mjs";
import { run } from "../../../viewer/tests/command.mjs";

const { SSCC_PACKAGE, SSCC_DIGESTS } = process.env;
const roots = { package: SSCC_PACKAGE, digests: SSCC_DIGESTS, tests: dirname(fileURLToPath(import.meta.url)) };
const types = { ".js": "text/javascript", ".mjs": "text/javascript", ".wasm": "application/wasm", ".html": "text/html" };
const folder = mkdtempSync(join(tmpdir(), "sscc-wasm-"));
let browser;
let server;
let origin;

before(async () => {
    server = createServer(({ url }, response) => {
        const [, root, ...rest] = new URL(url, "http://localhost").pathname.split("/");
        if (!roots[root]) {
            response.setHeader("Content-Type", "text/html");
            response.end("<!doctype html><title>package</title><link rel=icon href=data:,>");
            return;
        }
        const path = join(roots[root], ...rest);
        response.setHeader("Content-Type", types[extname(path)] ?? "application/octet-stream");
        response.end(readFileSync(path));
    });
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    origin = `http://127.0.0.1:${server.address().port}`;
    browser = await launch();
});
after(async () => {
    await browser?.close();
    server?.close();
    rmSync(folder, { recursive: true, force: true });
});

test("certificates and answers of five models have the native bytes", async () => {
    const page = await browser.newPage();
    await page.goto(`${origin}/`);
    const found = await page.evaluate(async () => {
        const sscc = await import("/package/queries.js");
        await sscc.default();
        const { compare } = await import("/tests/models.mjs");
        return compare(sscc, async (name) => new Uint8Array(await (await fetch(`/digests/${name}`)).arrayBuffer()));
    });
    assert.deepEqual(found, { models: 5, differences: [] });
    await page.close();
});

test("sliders of a report check every shape with the network off", async () => {
    const [model, certificates] = ["strips.model.safetensors", "strips.sscc.safetensors"].map((name) => join(folder, name));
    copyFileSync(join(SSCC_DIGESTS, "strips.model"), model);
    copyFileSync(join(SSCC_DIGESTS, "strips.certificates"), certificates);
    const [report, plain] = ["checks.html", "plain.html"].map((name) => join(folder, name));
    const view = ["view", model, "--certificates", certificates, "--report"];
    await run(...view, report, "--wasm", SSCC_PACKAGE);
    await run(...view, plain);
    assert.ok(statSync(report).size > statSync(plain).size);

    const { page, context, errors, requests } = await open(browser, pathToFileURL(report).href, { offline: true });
    const verdict = () => page.locator(".verdict-text").innerText();
    const slider = page.getByRole("slider").nth(1);
    const { min, max } = await slider.evaluate(({ min, max }) => ({ min: Number(min), max: Number(max) }));
    const kinds = new Set();
    for (let step = 0; step <= 8; step++) {
        await slider.fill(String(min + ((max - min) * step) / 8));
        await answered(page);
        const { q, answer } = await page.evaluate(() => {
            const { checker, pose } = globalThis.sscc;
            return { q: [...pose.q], answer: checker.answer };
        });
        const line = await run("check", model, "--certificates", certificates, `--q=${q.join(",")}`, "--json");
        const native = JSON.parse(line);
        for (const key of ["norm", "colliding", "count", "complete", "pairs", "root_certified", "opened", "box_tests", "triangle_tests"])
            assert.deepEqual(answer[key], native[key], `${key} at ${q}`);
        assert.equal((await verdict()).startsWith("COLLIDING"), native.colliding);
        kinds.add(native.colliding);
    }
    assert.equal(kinds.size, 2, "the slider passes free and colliding shapes");
    assert.deepEqual(errors, []);
    assert.deepEqual(requests, [pathToFileURL(report).href]);
    // A report has no server for searches.
    for (const name of ["To a collision", "Find first collisions"])
        assert.equal(await page.getByRole("button", { name }).count(), 0, name);
    await page.getByRole("tab", { name: "About" }).click();
    assert.match(await page.locator(".about").innerText(), /checks each shape itself/);
    // A report also has no server for the nodes that these keys show in the live page.
    for (const key of ["k", "b"]) {
        await page.keyboard.press(key);
        assert.ok(await page.locator(".message").isHidden(), `${key}: ${await page.locator(".message").innerText()}`);
    }
    await context.close();

    const other = await open(browser, pathToFileURL(plain).href, { offline: true });
    await other.page.getByRole("slider").nth(1).fill(String(max));
    await other.page.getByText("not checked: this is a report").waitFor();
    await other.context.close();
});
