// Five users' jobs from their files to an answer on the page: an artist, a statistician, a mechanic, a character, an engine.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { answered, launch, open } from "./browser.mjs";
import { run, view } from "./command.mjs";
import { rig, WITHIN } from "./rig.mjs";

const folder = mkdtempSync(join(tmpdir(), "sscc-jobs-"));
const inFolder = (name) => join(folder, name);
let browser;

before(async () => {
    browser = await launch();
});
after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
});

/** Opens an address and runs the steps. Fails after an error of the page. */
async function look(address, steps) {
    const { page, context, errors } = await open(browser, address, { reducedMotion: "reduce" });
    try {
        await steps(page);
        assert.deepEqual(errors, []);
    } finally {
        await context.close();
    }
}

const report = (name) => pathToFileURL(inFolder(name)).href;
const verdict = (page) => page.locator(".verdict-text").innerText();

/** A plate, and a wing beside it whose free end is at this height: two sheets of an OBJ file. */
function wing(height) {
    const plate = [
        [-1, -1, 0],
        [1, -1, 0],
        [1, 1, 0],
        [-1, 1, 0],
    ];
    const sheet = [
        [-0.5, -0.5, 1],
        [-0.5, 0.5, 1],
        [0.5, 0.5, height],
        [0.5, -0.5, height],
    ];
    const vertices = [...plate, ...sheet].map((p) => `v ${p.join(" ")}\n`).join("");
    return `${vertices}f 1 2 3\nf 1 3 4\nf 5 6 7\nf 5 7 8\n`;
}

/** Shapes of the wing as files of a folder. */
function frames(name, heights) {
    mkdirSync(inFolder(name));
    heights.forEach((height, i) => {
        writeFileSync(join(inFolder(name), `${i}.obj`), wing(height));
    });
    return inFolder(name);
}

test("an artist sees which targets collide, over which weights and how deep", async () => {
    writeFileSync(inFolder("rig.gltf"), rig(6));
    await run("sweep", inFolder("rig.gltf"), "--intervals", "--report", inFolder("sweep.html"));
    await look(report("sweep.html"), async (page) => {
        assert.equal(await page.locator(".collision-marks").count(), 2);
        assert.equal(await page.locator(".free-marks").count(), 6);
        const mark = page.getByRole("button", { name: `${WITHIN} collides from 0.2500 to 0.5500` });
        await mark.click();
        const weight = await page.evaluate(() => globalThis.sscc.pose.q[1]);
        assert.ok(weight > 0.25 && weight < 0.55, String(weight));
        await page.getByRole("tab", { name: "Plots" }).click();
        assert.equal(await page.getByText(/^penetration depth, /).count(), 2);
        await page.getByText(`penetration depth, ${WITHIN}`).waitFor();
    });
});

test("a statistician sees how far principal components go until the shape touches itself", async () => {
    const heights = [0.6, 0.8, 1, 1.2, 1.4];
    const model = inFolder("wing.model.safetensors");
    await run("modes", frames("samples", heights), "-o", model, "--kind", "pca", "--rank", "1");
    const server = await view(model);
    try {
        await look(server.address, async (page) => {
            // Three standard deviations of the heights.
            const spread = await page.evaluate(() => globalThis.sscc.shape.model.ranges[0]);
            assert.ok(spread[0] < 0 && spread[0] === -spread[1]);
            await page.getByRole("button", { name: "Mark collisions" }).click();
            await page.locator(".collision-marks, .free-marks").waitFor();
            await answered(page);
            assert.match(await verdict(page), /^free: proven/);
        });
    } finally {
        await server.stop();
    }
});

test("a mechanic loads a part, and sees its shape under the load", async () => {
    const { vertices, tets } = bar();
    const lists = [
        `Vertices ${vertices.length}\n${vertices.map((p) => `${p.join(" ")} 0\n`).join("")}`,
        `Tetrahedra ${tets.length}\n${tets.map((t) => `${t.map((v) => v + 1).join(" ")} 0\n`).join("")}`,
    ];
    writeFileSync(inFolder("bar.mesh"), `MeshVersionFormatted 1\nDimension 3\n${lists.join("")}End\n`);
    const [model, q] = [inFolder("bar.model.safetensors"), inFolder("load.npy")];
    const box = ["--fix", "box:-0.001,-1,-1,0.001,1,1"];
    await run("modes", inFolder("bar.mesh"), "-o", model, "--kind", "linear", "--rank", "4", ...box);
    await run("load", model, "--gravity", "-o", q);
    const server = await view(model);
    try {
        await look(server.address, async (page) => {
            await page.getByRole("button", { name: "Load q…" }).click();
            await page.locator('.dialog input[type="file"]').setInputFiles(q);
            await page.waitForFunction(() => globalThis.sscc.pose.q.some((weight) => weight !== 0));
            await answered(page);
            assert.match(await verdict(page), /^free: proven/);
        });
    } finally {
        await server.stop();
    }
});

/** A bar of cubes along x, each cut into six tetrahedra (m). */
function bar() {
    const [n, size] = [6, 0.02];
    const vertices = [];
    for (let i = 0; i <= n; i++)
        for (const y of [0, size]) for (const z of [0, size]) vertices.push([i * size, y, z]);
    const tets = [];
    for (let i = 0; i < n; i++) {
        const [a, b, c, d] = [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3];
        const [e, f, g, h] = [a + 4, b + 4, c + 4, d + 4];
        tets.push([a, e, g, h], [a, g, c, h], [a, c, d, h], [a, d, b, h], [a, b, f, h], [a, f, e, h]);
    }
    return { vertices, tets };
}

test("an animator sees each part of a character, frame by frame", async () => {
    writeFileSync(inFolder("rig2.gltf"), rig(2));
    const args = ["check", inFolder("character.gltf"), "--animation", "wave", "--fps", "4"];
    writeFileSync(inFolder("character.gltf"), JSON.stringify(character()));
    const text = await run(...args, "--between-nodes", "--report", inFolder("wave.html"));
    assert.match(text, /node 0 body against node 1 shirt .* COLLIDING/);
    await look(report("wave.html"), async (page) => {
        assert.deepEqual(await page.evaluate(() => globalThis.sscc.scene.playback.bodies.map((body) => body.name)), [
            "node 0 body",
            "node 1 shirt",
        ]);
    });
});

/** A plate, and a triangle above it that falls through it in a second. */
function character() {
    const data = (numbers) => {
        const bytes = Buffer.from(new Float32Array(numbers).buffer);
        return { byteLength: bytes.length, uri: `data:;base64,${bytes.toString("base64")}` };
    };
    const float = (bufferView, count, type) => ({ bufferView, componentType: 5126, count, type });
    const lists = [
        [0, 0, 0, 4, 0, 0, 0, 4, 0],
        [1, 1, 1, 1.5, 1, 1, 1, 1, 1.5],
        [0, 1],
        [0, 0, 0, 0, 0, -2],
    ];
    return {
        asset: { version: "2.0" },
        buffers: lists.map(data),
        bufferViews: lists.map((list, buffer) => ({ buffer, byteLength: 4 * list.length })),
        accessors: [float(0, 3, "VEC3"), float(1, 3, "VEC3"), float(2, 2, "SCALAR"), float(3, 2, "VEC3")],
        meshes: [0, 1].map((accessor) => ({ primitives: [{ attributes: { POSITION: accessor } }] })),
        nodes: [
            { mesh: 0, name: "body" },
            { mesh: 1, name: "shirt" },
        ],
        animations: [
            {
                name: "wave",
                channels: [{ sampler: 0, target: { node: 1, path: "translation" } }],
                samplers: [{ input: 2, output: 3 }],
            },
        ],
    };
}

test("an engine's frames play with their collisions", async () => {
    writeFileSync(inFolder("wing.obj"), wing(1));
    const shapes = frames("frames", [1, 0.5, -0.5, 1]);
    const args = ["check", inFolder("wing.obj"), "--frames", shapes, "--report", inFolder("frames.html")];
    assert.match(await run(...args), /4 frames: 3 free, 1 colliding/);
    await look(report("frames.html"), async (page) => {
        await page.getByRole("slider", { name: "frame" }).fill("2");
        await page
            .getByText(/COLLIDING/)
            .first()
            .waitFor();
    });
});
