// Reports of `sscc check`: meshes without modes, their frames and animations.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch, nameless, open } from "./browser.mjs";
import { run } from "./command.mjs";
import { atTime, parse } from "./glb.mjs";
import { drawnBox, orange, pixels, settled, white } from "./picture.mjs";

const folder = mkdtempSync(join(tmpdir(), "sscc-meshes-"));
/** Far from the origin: single precision there has steps of 1/16. */
const FAR = 1_000_000;
const HEIGHTS = [1, 0.5, 0.25, -0.25, -0.5, 0.75];
let browser;

/** A square of two triangles in the plane z = 0, and an upright one that begins at this height. */
function positions(height) {
    const lower = [
        [-1, -1, 0],
        [1, -1, 0],
        [1, 1, 0],
        [-1, 1, 0],
    ];
    const upper = [
        [-0.5, 0.1, height],
        [0.5, 0.1, height],
        [0.5, 0.1, height + 1],
        [-0.5, 0.1, height + 1],
    ];
    return [...lower, ...upper].map(([x, y, z]) => [x + FAR, y, z]);
}

const FACES = ["1 2 3", "1 3 4", "5 6 7", "5 7 8"];

function obj(vertices, faces) {
    return `${vertices.map((p) => `v ${p.join(" ")}`).join("\n")}\n${faces.map((f) => `f ${f}`).join("\n")}\n`;
}

/** A glTF file with the mesh at two nodes; an animation lifts the second one by 3 in a second. */
function gltf() {
    const numbers = new Float32Array([
        ...positions(-0.5).flatMap(([x, y, z]) => [x - FAR, y, z]),
        0,
        1,
        0,
        0,
        0,
        0,
        0,
        3,
    ]);
    const faces = new Uint32Array(FACES.flatMap((face) => face.split(" ").map((v) => Number(v) - 1)));
    const bytes = Buffer.concat([Buffer.from(numbers.buffer), Buffer.from(faces.buffer)]);
    const float = { componentType: 5126 };
    return JSON.stringify({
        asset: { version: "2.0" },
        buffers: [
            { byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` },
        ],
        bufferViews: [
            { buffer: 0, byteLength: 96 },
            { buffer: 0, byteOffset: 96, byteLength: 8 },
            { buffer: 0, byteOffset: 104, byteLength: 24 },
            { buffer: 0, byteOffset: 128, byteLength: 48 },
        ],
        accessors: [
            { ...float, bufferView: 0, count: 8, type: "VEC3" },
            { ...float, bufferView: 1, count: 2, type: "SCALAR" },
            { ...float, bufferView: 2, count: 2, type: "VEC3" },
            { bufferView: 3, componentType: 5125, count: 12, type: "SCALAR" },
        ],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 3 }] }],
        nodes: [{ mesh: 0 }, { mesh: 0, translation: [4, 0, 0] }],
        scenes: [{ nodes: [0, 1] }],
        scene: 0,
        animations: [
            {
                name: "lift",
                channels: [{ sampler: 0, target: { node: 1, path: "translation" } }],
                samplers: [{ input: 1, output: 2 }],
            },
        ],
    });
}

/** Runs `sscc check ... --json --report`; returns the answers and the address of the report. */
async function check(name, ...args) {
    const file = join(folder, `${name}.html`);
    const lines = await run("check", ...args, "--json", "--report", file);
    const answers = lines
        .trim()
        .split("\n")
        .map((line) => JSON.parse(line));
    return { answers, address: pathToFileURL(file).href };
}

/** Opens a report and runs the steps. Fails after an error of the page or a request to another address. */
async function look(address, steps, options = {}) {
    const { page, context, errors, requests } = await open(browser, address, options);
    try {
        await steps(page, context);
        assert.deepEqual(errors, []);
        const elsewhere = requests.filter((url) => !/^(file|blob|data):/.test(url));
        assert.deepEqual(elsewhere, []);
    } finally {
        await context.close();
    }
}

const inFolder = (name) => join(folder, name);
const verdict = (page) => page.locator(".verdict-text").innerText();
const marked = (page, body) => page.evaluate((b) => globalThis.sscc.stage.bodies[b].markedTriangles(0), body);
const curves = (page) => page.evaluate(() => globalThis.sscc.stage.curves.count);
const triangles = (pairs) => [...new Set(pairs.flat())].sort((a, b) => a - b);

async function seek(page, frame) {
    await page.getByRole("slider", { name: "frame" }).fill(String(frame));
    await settled(page);
}

before(async () => {
    writeFileSync(inFolder("mesh.obj"), obj(positions(HEIGHTS[0]), FACES));
    writeFileSync(inFolder("plate.obj"), obj(positions(0).slice(0, 4), FACES.slice(0, 2)));
    writeFileSync(inFolder("upright.obj"), obj(positions(-0.3).slice(4), FACES.slice(0, 2)));
    writeFileSync(inFolder("nodes.gltf"), gltf());
    mkdirSync(inFolder("frames"));
    HEIGHTS.forEach((height, i) => {
        writeFileSync(inFolder(`frames/${i}.obj`), obj(positions(height), FACES));
    });
    browser = await launch();
});
after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
});

describe("frames", () => {
    let report;
    before(async () => {
        report = await check("frames", inFolder("mesh.obj"), "--frames", inFolder("frames"));
    });

    test("play with their colliding triangles and curves, without panels of modes", () =>
        look(report.address, async (page) => {
            const { answers } = report;
            assert.deepEqual(
                answers.map((answer) => answer.colliding),
                [false, false, false, true, true, false],
            );
            assert.deepEqual(await page.locator("[role=tab]").allInnerTexts(), ["Collisions", "Plots", "About"]);
            assert.equal(await page.locator(".mode").count(), 0);
            assert.ok(await page.locator(".bar").isHidden());
            assert.equal(await page.locator(".subtitle").innerText(), "4 triangles, 6 frames");
            assert.deepEqual(await nameless(page), []);
            assert.equal(await verdict(page), "free (as recorded), apart from pairs with common vertices");
            assert.equal(await page.locator(".clock").innerText(), "frame 0");
            assert.equal(orange(await pixels(page)), 0);
            assert.equal(white(await pixels(page)), 0);
            await page.getByRole("button", { name: "next self-contact" }).click();
            await settled(page);
            for (const frame of [3, 4]) {
                assert.equal(await page.locator(".clock").innerText(), `frame ${frame}`);
                assert.equal(await verdict(page), `COLLIDING ${answers[frame].count} pairs (as recorded)`);
                assert.deepEqual(await marked(page, 0), triangles(answers[frame].pairs));
                assert.ok((await curves(page)) > 0);
                const picture = await pixels(page);
                assert.ok(orange(picture) > 300 && white(picture) > 30, `${orange(picture)}, ${white(picture)}`);
                await page.keyboard.press(".");
                await settled(page);
            }
            assert.equal(await verdict(page), "free (as recorded), apart from pairs with common vertices");
            assert.deepEqual(await marked(page, 0), []);
            assert.equal(await curves(page), 0);
            assert.equal(white(await pixels(page)), 0);
            await page.keyboard.press("t");
            await seek(page, 0);
            await page.keyboard.press(" ");
            await page.waitForFunction(() => globalThis.player.timeline.frame === 5);
        }));

    test("are drawn at their positions, in their precision far from the origin", () =>
        look(report.address, async (page) => {
            for (const frame of [0, 4]) {
                await seek(page, frame);
                const drawn = await page.evaluate((frame) => {
                    const { meshes } = globalThis.player;
                    const { center } = meshes.data.bodies[0];
                    return [...meshes.positions(0, frame)].map((x, i) => x + center[i % 3]);
                }, frame);
                for (const [i, x] of positions(HEIGHTS[frame]).flat().entries())
                    assert.ok(Math.abs(drawn[i] - x) < 1e-6, `${i}: ${drawn[i]}, ${x}`);
                const due = await page.evaluate(() => {
                    const { stage } = globalThis.sscc;
                    const { meshes, timeline } = globalThis.player;
                    const x = meshes.positions(0, timeline.frame);
                    const point = stage.camera.position.clone();
                    const { clientWidth, clientHeight } = stage.canvas;
                    const box = [clientWidth, clientHeight, 0, 0];
                    for (let v = 0; v < x.length; v += 3) {
                        point.set(x[v], x[v + 1], x[v + 2]).project(stage.camera);
                        const at = [((point.x + 1) / 2) * clientWidth, ((1 - point.y) / 2) * clientHeight];
                        at.forEach((value, i) => {
                            box[i] = Math.min(box[i], value);
                            box[2 + i] = Math.max(box[2 + i], value);
                        });
                    }
                    return box;
                });
                const { left, top, right, bottom } = drawnBox(await pixels(page));
                [left, top, right, bottom].forEach((side, i) => {
                    assert.ok(Math.abs(side - due[i]) < 4, `${i}: ${side}, ${due[i]}`);
                });
            }
        }));

    test("list their pairs, and fly to them", () =>
        look(report.address, async (page) => {
            await seek(page, 4);
            const pairs = report.answers[4].pairs.map(([a, b]) => `${a} – ${b}`);
            assert.deepEqual(await page.locator(".pair").allInnerTexts(), pairs);
            const place = () => page.evaluate(() => globalThis.sscc.stage.camera.position.toArray());
            const before = await place();
            await page.keyboard.press("n");
            await page.waitForFunction(
                (before) =>
                    globalThis.sscc.stage.camera.position.toArray().some((x, i) => Math.abs(x - before[i]) > 0.1),
                before,
            );
            assert.equal(await page.locator(".pair").first().getAttribute("aria-pressed"), "true");
            await seek(page, 0);
            assert.equal(await page.locator(".pair").count(), 0);
            assert.equal(await page.locator(".collisions h2").innerText(), "No pair collides in this frame");
        }));

    test("are saved as GLB; three.js plays the same positions", () =>
        look(report.address, async (page) => {
            const button = page.getByRole("button", { name: "save the motion" });
            const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
            const glb = await parse(readFileSync(await download.path()));
            for (const [frame, height] of HEIGHTS.entries()) {
                const x = atTime(glb, frame / 30);
                for (const [i, due] of positions(height).flat().entries())
                    assert.ok(Math.abs(x[i] - due) < 1e-4, `frame ${frame}, ${i}: ${x[i]}, ${due}`);
            }
        }));

    test("fit the width of a phone, and need no WebGL", async () => {
        await look(
            report.address,
            async (page) => {
                for (const tab of ["Collisions", "Plots", "About"]) {
                    await page.getByRole("tab", { name: tab }).click();
                    assert.ok((await page.evaluate(() => document.scrollingElement.scrollWidth)) <= 390, tab);
                }
            },
            { width: 390, height: 844 },
        );
        const without = await launch(["--disable-3d-apis"]);
        try {
            const { page, errors } = await open(without, report.address);
            await seek(page, 4);
            assert.match(await verdict(page), /^COLLIDING/);
            await page.keyboard.press("n");
            assert.deepEqual(errors, []);
        } finally {
            await without.close();
        }
    });
});

test("continuous checks mark the pairs of the next step, with the earliest time", async () => {
    const { answers, address } = await check(
        "continuous",
        inFolder("mesh.obj"),
        "--frames",
        inFolder("frames"),
        "--continuous",
    );
    await look(address, async (page) => {
        assert.equal(
            await verdict(page),
            "free until the next frame (as recorded), apart from pairs with common vertices",
        );
        // The upright square passes the other one halfway from frame 2 to frame 3.
        await page.getByRole("button", { name: "next self-contact" }).click();
        await settled(page);
        assert.equal(await page.locator(".clock").innerText(), "frame 2");
        const { pairs, times } = answers[2];
        assert.ok(Math.abs(Math.min(...times) - 0.5) < 1e-9);
        const text = `COLLIDING ${pairs.length} pairs until the next frame, first at 0.5000 of the step (as recorded)`;
        assert.equal(await verdict(page), text);
        assert.deepEqual(await marked(page, 0), triangles(pairs));
        assert.equal(await curves(page), 0);
        assert.deepEqual(
            await page.locator(".pair").allInnerTexts(),
            pairs.map(([a, b], i) => `${a} – ${b} at ${times[i].toFixed(4)}`),
        );
        await seek(page, 3);
        assert.ok((await curves(page)) > 0);
        await seek(page, 5);
        assert.equal(await verdict(page), "the last frame: no step follows");
    });
});

test("two meshes are two bodies", async () => {
    const { answers, address } = await check("against", inFolder("plate.obj"), "--against", inFolder("upright.obj"));
    await look(address, async (page) => {
        assert.equal(await page.locator("h1").innerText(), "plate.obj against upright.obj");
        // A mesh at rest has nothing to play.
        assert.ok(await page.locator(".timeline").isHidden());
        assert.equal(await verdict(page), `COLLIDING ${answers[0].count} pairs (as recorded)`);
        for (const body of [0, 1])
            assert.deepEqual(await marked(page, body), triangles(answers[0].pairs.map((pair) => pair[body])));
        assert.ok((await curves(page)) > 0);
        const button = page.getByRole("button", { name: "save a picture" });
        const [picture] = await Promise.all([page.waitForEvent("download"), button.click()]);
        assert.equal(picture.suggestedFilename(), "plate.obj.png");
        const glb = page.getByRole("button", { name: "save the motion" });
        const [motion] = await Promise.all([page.waitForEvent("download"), glb.click()]);
        assert.equal((await parse(readFileSync(await motion.path()))).animations.length, 0);
    });
});

test("the nodes of an animation are bodies, each with its pairs", async () => {
    const { answers, address } = await check("nodes", inFolder("nodes.gltf"), "--animation", "lift", "--fps", "4");
    await look(address, async (page) => {
        assert.equal(answers.length, 10);
        await seek(page, 4);
        assert.equal(await page.locator(".clock").innerText(), "frame 4, 1.000 s");
        const both = answers.filter((answer) => answer.index === 4);
        const count = both[0].count + both[1].count;
        assert.equal(await verdict(page), `COLLIDING ${count} pairs (as recorded)`);
        for (const body of [0, 1]) assert.deepEqual(await marked(page, body), triangles(both[body].pairs));
        const names = await page.locator(".pair").allInnerTexts();
        assert.equal(names.length, count);
        assert.match(names[0], /^node 0: /);
        assert.match(names.at(-1), /^node 1: /);
        const height = await page.evaluate(() => {
            const { meshes } = globalThis.player;
            return [0, 1].map((body) => meshes.positions(body, 4)[2] - meshes.positions(body, 0)[2]);
        });
        assert.deepEqual(height, [0, 3]);
    });
});
