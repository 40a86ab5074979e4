// Reports: the page with its data, opened as a file.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { pathToFileURL } from "node:url";
import { deflateSync } from "node:zlib";
import { builtPage, launch, nameless, open } from "./browser.mjs";
import { base64, report, withReport } from "./fixture.mjs";
import { atTime, isBounded, parse } from "./glb.mjs";
import { drawnBox, expectedBox, orange, pixels, settled } from "./picture.mjs";

const folder = mkdtempSync(join(tmpdir(), "sscc-page-"));
const html = readFileSync(builtPage, "utf8");
let browser;

function write(name, options) {
    const file = join(folder, `${name}.html`);
    writeFileSync(file, withReport(html, report(options)));
    return pathToFileURL(file).href;
}

before(async () => {
    browser = await launch();
});
after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
});

/** Opens a report and runs the steps. Fails after an error of the page or a request to another address. */
async function look(options, steps) {
    const { page, context, errors, requests } = await open(browser, write("report", options), options);
    try {
        await steps(page, context);
        assert.deepEqual(errors, []);
        const elsewhere = requests.filter((url) => !/^(file|blob|data):/.test(url));
        assert.deepEqual(elsewhere, []);
    } finally {
        await context.close();
    }
}

describe("the shape", () => {
    test("is deformed on the graphics card as by the processor", () =>
        look({ playback: false }, async (page) => {
            // Zooms out until every shape below is entirely in the picture.
            await page.focus(".stage canvas");
            for (let i = 0; i < 6; i++) await page.keyboard.press("-");
            // Removes the focus ring.
            await page.evaluate(() => document.activeElement.blur());
            for (const q of [
                [0, 0, 0, 0],
                [0.9, 0, 0, 0],
                [0.3, -0.5, 0.6, 0.8],
                [-1, 0, 0, -1],
            ]) {
                await page.evaluate((q) => globalThis.sscc.pose.show(q), q);
                await settled(page);
                const picture = await pixels(page);
                const [drawn, due] = [drawnBox(picture), await expectedBox(page)];
                assert.ok(due.left > 0 && due.top > 0 && due.right < picture.width && due.bottom < picture.height);
                for (const side of ["left", "right", "top", "bottom"]) {
                    assert.ok(Math.abs(drawn[side] - due[side]) < 4, `${side} of ${q}: ${drawn[side]}, ${due[side]}`);
                }
            }
        }));

    test("is rotated by dragging and keys, and zoomed by the wheel", () =>
        look({ playback: false }, async (page) => {
            const place = () => page.evaluate(() => globalThis.sscc.stage.camera.position.toArray());
            /** Waits until the camera has moved by more than `apart`, to less than `ratio` times the distance. */
            const until = async (from, apart, ratio) => {
                await page.waitForFunction(
                    ([from, apart, ratio]) => {
                        const at = globalThis.sscc.stage.camera.position.toArray();
                        const moved = Math.hypot(...at.map((v, i) => v - from[i]));
                        return moved > apart && Math.hypot(...at) < ratio * Math.hypot(...from);
                    },
                    [from, apart, ratio],
                );
                return place();
            };
            const first = await place();
            await page.mouse.move(300, 300);
            await page.mouse.down();
            await page.mouse.move(420, 340, { steps: 4 });
            await page.mouse.up();
            const turned = await until(first, 0.3, 1.001);
            await page.mouse.wheel(0, -400);
            const near = await until(turned, 0.05, 0.95);
            await page.focus(".stage canvas");
            await page.keyboard.press("ArrowLeft");
            await until(near, 0.05, 1.001);
        }));

    test("follows the slider of a mode; a double click resets it", () =>
        look({ playback: false }, async (page) => {
            const before = drawnBox(await pixels(page));
            const slider = page.locator('.mode input[type="range"]').first();
            await slider.fill("0.8");
            assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), 0.8);
            await settled(page);
            const bent = drawnBox(await pixels(page));
            assert.ok(bent.bottom - bent.top > 1.5 * (before.bottom - before.top));
            await slider.dblclick();
            assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), 0);
        }));

    test("vibrates until it is stopped", () =>
        look({ playback: false }, async (page) => {
            const button = page.getByRole("button", { name: "vibrate mode 0" });
            await button.click();
            assert.equal(await button.getAttribute("aria-pressed"), "true");
            await page.waitForFunction(() => globalThis.sscc.pose.q[0] > 0.05);
            await page.waitForFunction(() => globalThis.sscc.pose.q[0] < -0.05);
            await button.click();
            const still = await page.evaluate(() => globalThis.sscc.pose.q[0]);
            await page.waitForTimeout(100);
            assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), still);
        }));

    test("accepts q pasted, and from text and .npy files", () =>
        look({ playback: false }, async (page) => {
            const q = () => page.evaluate(() => [...globalThis.sscc.pose.q]);
            await page.getByRole("button", { name: "Load q…" }).click();
            await page.getByRole("textbox", { name: "numbers" }).fill("[0.25, -0.5\n 0 1e-1]");
            await page.getByRole("button", { name: "Show", exact: true }).click();
            assert.deepEqual(await q(), [0.25, -0.5, 0, 0.1]);
            await page.keyboard.press("l");
            await page.getByRole("textbox", { name: "numbers" }).fill("1 2 x");
            await page.getByRole("button", { name: "Show", exact: true }).click();
            assert.match(await page.locator(".dialog .wrong").innerText(), /line 1: 'x' is not a number/);
            // Empty lines and comments count.
            await page.getByRole("textbox", { name: "numbers" }).fill("# weights\n\n1 2\n3 y");
            await page.getByRole("button", { name: "Show", exact: true }).click();
            assert.match(await page.locator(".dialog .wrong").innerText(), /line 4: 'y' is not a number/);
            await page.getByRole("textbox", { name: "numbers" }).fill("1 2");
            await page.getByRole("button", { name: "Show", exact: true }).click();
            assert.match(await page.locator(".dialog .wrong").innerText(), /2 numbers, the model has 4 modes/);
            const file = {
                name: "q.npy",
                mimeType: "application/octet-stream",
                buffer: npy([0.5, 0, -0.25, 0], [4]),
            };
            await page.locator('.dialog input[type="file"]').setInputFiles(file);
            await page.waitForFunction(() => globalThis.sscc.pose.q[2] === -0.25);
            assert.deepEqual(await q(), [0.5, 0, -0.25, 0]);
            await page.locator(".dialog").waitFor({ state: "detached" });
            await page.keyboard.press("l");
            const rows = npy([0.1, 0, 0, 0, 0.2, 0, 0, 0, 0.3, 0, 0, 0], [3, 4]);
            await page.locator('.dialog input[type="file"]').setInputFiles({ ...file, buffer: rows });
            await page.waitForFunction(() => globalThis.sscc.pose.q[0] > 0.299);
            await page.locator(".dialog").waitFor({ state: "detached" });
            await page.keyboard.press("l");
            const cut = { ...file, buffer: rows.subarray(0, rows.length - 5) };
            await page.locator('.dialog input[type="file"]').setInputFiles(cut);
            await page.getByText("the .npy file is truncated or too long").waitFor();
            for (const [buffer, columns] of [
                [npy([0, 0, 0, 0, 0, 0], [2, 3]), 3],
                // A small file, with a header that promises billions of empty rows.
                [npy([], [4294967295, 0]), 0],
            ]) {
                await page.locator('.dialog input[type="file"]').setInputFiles({ ...file, buffer });
                await page
                    .getByText(`each row of the .npy file has ${columns} numbers, the model has 4 modes`)
                    .waitFor();
            }
        }));

    test("a slider, a button and a vibration end the motion of loaded rows", () =>
        look({ playback: false }, async (page) => {
            const rows = Array.from({ length: 3000 }, (_, i) => `0 ${(i + 1) / 3000} 0 0`).join("\n");
            // Events without a mouse: while frames are drawn, each wait for a resting button takes some of them.
            const press = (name) =>
                page.getByRole("button", { name, exact: true }).evaluate((button) => button.click());
            const load = async (text) => {
                await page.keyboard.press("l");
                await page.getByRole("textbox", { name: "numbers" }).evaluate((box, text) => {
                    box.value = text;
                }, text);
                await press("Show");
            };
            await load(rows);
            const state = () =>
                page.evaluate(() => ({
                    q: [...globalThis.sscc.pose.q],
                    playing: globalThis.player.timeline.playing,
                    motion: globalThis.sscc.motion.name,
                }));
            const play = async () => {
                await page.evaluate(() => globalThis.player.timeline.start());
                await page.waitForFunction(() => {
                    globalThis.at ??= globalThis.sscc.pose.q[1];
                    return globalThis.sscc.pose.q[1] > globalThis.at;
                });
                await page.evaluate(() => delete globalThis.at);
            };
            const stays = async (q) => {
                await page.waitForTimeout(200);
                assert.deepEqual(await state(), { q, playing: false, motion: null });
            };
            await play();
            await page.getByRole("button", { name: "Reset" }).click();
            await stays([0, 0, 0, 0]);
            await play();
            await page.locator('.mode input[type="range"]').nth(1).fill("-0.5");
            await stays([0, -0.5, 0, 0]);
            await play();
            await page.keyboard.press("l");
            await page.getByRole("textbox", { name: "numbers" }).fill("0.25 -0.25 0 0");
            await page.getByRole("button", { name: "Show", exact: true }).click();
            await stays([0.25, -0.25, 0, 0]);
            await page.getByRole("button", { name: "Reset" }).click();
            await play();
            await page.getByRole("button", { name: "vibrate mode 0" }).click();
            await page.waitForFunction(() => globalThis.sscc.pose.q[0] > 0.05);
            const { q, playing, motion } = await state();
            assert.deepEqual([playing, motion], [false, "vibrating mode 0"]);
            assert.ok(q[1] > 0);
            // The timeline ends the vibration.
            await play();
            await page.waitForFunction(() => globalThis.sscc.motion.name === null);
            assert.equal((await state()).q[0], 0);
        }));
});

/** A .npy file of float64. */
function npy(values, shape) {
    const tuple = shape.length === 1 ? `(${shape[0]},)` : `(${shape.join(", ")})`;
    const words = `{'descr': '<f8', 'fortran_order': False, 'shape': ${tuple}, }`;
    const header = `${words.padEnd(117)}\n`;
    const head = Buffer.from([0x93, ...Buffer.from("NUMPY"), 1, 0, header.length, 0]);
    return Buffer.concat([head, Buffer.from(header, "latin1"), Buffer.from(new Float64Array(values).buffer)]);
}

/** Gives the model morph targets with these names, which move nothing but the first ones. */
const targets = (names) => (scene, arrays) => {
    const [model] = scene.models;
    const { rank } = model;
    const none = (value) => Array.from({ length: names.length - rank }, () => value);
    const zeros = Buffer.alloc(4 * 3 * model.vertices * (names.length - rank));
    arrays.u = Buffer.concat([Buffer.from(arrays.u, "base64"), zeros]).toString("base64");
    Object.assign(model, {
        rank: names.length,
        mode_names: names,
        frequencies: null,
        ranges: names.map(() => [0, 1]),
        extremal: [],
    });
    for (const key of ["center", "default_q"]) model[key].push(...none(0));
    for (const key of ["scales", "limits"]) model[key].push(...none(1));
};

describe("morph targets", () => {
    const long = "the_corner_of_the_mouth_is_pulled_up_and_back_towards_the_ear_by_the_zygomaticus_major_on_the_left";
    const names = ["jawOpen", long, "mouthSmile_L", "mouthSmile_R"];
    const many = [...names, ...Array.from({ length: 596 }, (_, k) => `corrective_${k}_of_jawOpen`)];
    const shown = (page) => page.locator(".mode:visible .mode-name").allInnerTexts();

    test("have whole names, and sliders from 0 to 1", async () => {
        for (const width of [900, 390]) {
            await look({ playback: false, width, change: targets(names) }, async (page) => {
                assert.deepEqual(await shown(page), names);
                const cut = await page.locator(".mode-name").evaluateAll((elements) =>
                    elements.filter((e) => {
                        const [box, row] = [e.getBoundingClientRect(), e.closest(".mode").getBoundingClientRect()];
                        return e.scrollWidth > e.clientWidth + 1 || box.bottom > row.bottom || box.right > row.right;
                    }),
                );
                assert.equal(cut.length, 0);
                const slider = page.locator('.mode input[type="range"]').first();
                assert.deepEqual([await slider.getAttribute("min"), await slider.getAttribute("max")], ["0", "1"]);
                assert.equal(await slider.inputValue(), "0");
                await slider.press("End");
                assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), 1);
            });
        }
    });

    test("have weights beyond the slider by typing", () =>
        look({ playback: false, change: targets(names) }, async (page) => {
            const row = page.locator(".mode").first();
            const number = row.locator('input[type="number"]');
            const q = () => page.evaluate(() => globalThis.sscc.pose.q[0]);
            for (const weight of [1.5, -0.25]) {
                await number.fill(String(weight));
                await number.press("Enter");
                assert.equal(await q(), weight);
                assert.equal(await row.locator('input[type="range"]').inputValue(), weight > 1 ? "1" : "0");
                assert.match(await row.getAttribute("class"), /beyond/);
                await number.blur();
                assert.equal(Number(await number.inputValue()), weight);
            }
            await row.locator('input[type="range"]').fill("0.5");
            assert.equal(await q(), 0.5);
            assert.doesNotMatch(await row.getAttribute("class"), /beyond/);
        }));

    test("keep their weights where a typed text is no number", () =>
        look({ playback: false, change: targets(names) }, async (page) => {
            const row = page.locator(".mode").first();
            const number = row.locator('input[type="number"]');
            await row.locator('input[type="range"]').fill("0.5");
            for (const text of ["", "1e", "-"]) {
                await number.click();
                await number.fill("");
                await page.keyboard.type(text);
                await page.keyboard.press("Enter");
                assert.equal(await number.inputValue(), "0.5000", text);
                assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), 0.5, text);
            }
        }));

    test("vibrate within their range", () =>
        look({ playback: false, change: targets(names) }, async (page) => {
            const seen = await page.evaluate(async () => {
                const { pose } = globalThis.sscc;
                document.querySelector(".mode button").click();
                const seen = [];
                const start = performance.now();
                while (performance.now() - start < 2500) {
                    await new Promise((done) => requestAnimationFrame(done));
                    seen.push(pose.q[0]);
                }
                return [Math.min(...seen), Math.max(...seen)];
            });
            assert.ok(seen[0] >= 0 && seen[0] < 0.1 && seen[1] > 0.9 && seen[1] <= 1, seen.join());
        }));

    test("are filtered by the words of their names, also hundreds", () =>
        look({ playback: false, change: targets(many) }, async (page) => {
            const found = page.locator(".found");
            assert.equal(await found.innerText(), "600 modes");
            await page.keyboard.press("/");
            await page.keyboard.type("SMILE mouth");
            assert.deepEqual(await shown(page), ["mouthSmile_L", "mouthSmile_R"]);
            assert.equal(await found.innerText(), "2 of 600 modes");
            // The keys for the next and the previous slider skip hidden ones.
            await page.locator(".hint").first().click();
            for (const [key, mode] of [
                ["]", 2],
                ["]", 3],
                ["]", 3],
                ["[", 2],
            ]) {
                await page.keyboard.press(key);
                const focused = await page.evaluate(() =>
                    [...document.querySelectorAll(".mode")].indexOf(document.activeElement.closest(".mode")),
                );
                assert.equal(focused, mode, key);
            }
            await page.getByRole("searchbox", { name: "filter by name" }).fill("nothing has this name");
            assert.deepEqual(await shown(page), []);
            await page.getByRole("searchbox", { name: "filter by name" }).fill("");
            assert.equal(await page.locator(".mode:not([hidden])").count(), 600);
        }));

    test("hundreds: a change of one weight updates one row", () =>
        look({ playback: false, change: targets(many) }, async (page) => {
            const writes = await page.evaluate(() => {
                const { prototype } = HTMLInputElement;
                const own = Object.getOwnPropertyDescriptor(prototype, "value");
                let writes = 0;
                Object.defineProperty(prototype, "value", {
                    ...own,
                    set(value) {
                        writes++;
                        own.set.call(this, value);
                    },
                });
                globalThis.sscc.pose.change(300, 0.5);
                return writes;
            });
            assert.ok(writes >= 2 && writes <= 4, `${writes} writes`);
            assert.equal(await page.locator('.mode input[type="number"]').nth(300).inputValue(), "0.5000");
        }));
});

describe("playback", () => {
    test("frames the bodies, not their flight, and follows them", () =>
        look({ flight: 30, change: (scene) => (scene.playback.ground = null) }, async (page) => {
            for (const frame of [0, 30, 59, 10]) {
                await page.getByRole("slider", { name: "frame" }).fill(String(frame));
                await settled(page);
                const picture = await pixels(page);
                const box = drawnBox(picture);
                const width = box.right - box.left;
                assert.ok(width > 0.3 * picture.width, `frame ${frame}: ${width} of ${picture.width} pixels`);
                assert.ok(box.left > 0 && box.right < picture.width - 1, `frame ${frame}`);
                assert.ok(box.top > 0 && box.bottom < picture.height - 1, `frame ${frame}`);
            }
            // A view that a person has moved stays moved, and follows.
            const place = () =>
                page.evaluate(() => {
                    const mesh = globalThis.sscc.stage.bodies[0].group.children[0];
                    const matrix = globalThis.sscc.stage.camera.matrix.clone();
                    mesh.getMatrixAt(1, matrix);
                    const body = matrix.elements.slice(12, 15);
                    return globalThis.sscc.stage.camera.position.toArray().map((x, i) => x - body[i]);
                });
            await page.focus(".stage canvas");
            await page.keyboard.press("-");
            await page.keyboard.press("ArrowLeft");
            await settled(page);
            const before = await place();
            await page.getByRole("slider", { name: "frame" }).fill("59");
            await settled(page);
            const after = await place();
            const moved = Math.hypot(...after.map((x, i) => x - before[i]));
            assert.ok(moved < 0.3 * Math.hypot(...before), `${moved}`);
        }));

    test("plays by a clock, marks self-contacts, and shows the recorded answers", () =>
        look({}, async (page) => {
            const slider = page.getByRole("slider", { name: "frame" });
            const verdict = page.locator(".verdict-text");
            await slider.fill("5");
            await settled(page);
            assert.equal(await verdict.innerText(), "free (as recorded)");
            assert.equal(orange(await pixels(page)), 0);
            await page.getByRole("button", { name: "next self-contact" }).click();
            assert.equal(await slider.inputValue(), "20");
            await settled(page);
            assert.equal(await verdict.innerText(), "COLLIDING 5 pairs (as recorded)");
            const marked = await page.evaluate(() => globalThis.sscc.stage.bodies[0].markedTriangles(1));
            assert.deepEqual(
                marked,
                Array.from({ length: 40 }, (_, k) => 900 + k),
            );
            assert.ok(orange(await pixels(page)) > 30);
            assert.ok((await page.locator(".marks .contact").count()) >= 5);
            await page.keyboard.press(".");
            assert.equal(await slider.inputValue(), "21");
            await page.getByRole("button", { name: "play", exact: true }).click();
            await page.waitForFunction(() => globalThis.player.timeline.frame > 40);
            await page.waitForFunction(() => !globalThis.player.timeline.playing);
            assert.equal(await slider.inputValue(), "59");
        }));

    test("distinguishes collisions since the last frame from those of the frame", () =>
        look({}, async (page) => {
            const slider = page.getByRole("slider", { name: "frame" });
            const verdict = page.locator(".verdict-text");
            const since = page.locator(".gauge .since");
            await slider.fill("40");
            await settled(page);
            assert.equal(await verdict.innerText(), "free (as recorded)");
            assert.equal(await since.innerText(), "collided between frames: at most 2,922 pairs in one step");
            assert.match(await slider.getAttribute("aria-valuetext"), /^1.33 seconds, collided between frames$/);
            assert.equal(orange(await pixels(page)), 0);
            // Low marks here and at the end of the longer contact, lower than all others.
            const heights = (which) =>
                page.locator(which).evaluateAll((bars) => bars.map((bar) => Number(bar.getAttribute("height"))));
            assert.deepEqual(await heights(".marks .contact.since"), [4, 4]);
            assert.ok((await heights(".marks .contact:not(.since)")).every((height) => height >= 8));
            await page.keyboard.press(".");
            await settled(page);
            assert.equal(await verdict.innerText(), "free (as recorded)");
            assert.ok(await since.isHidden());
            await page.keyboard.press(",");
            await page.keyboard.press(",");
            await settled(page);
            assert.ok(await since.isHidden());
            await page.getByRole("button", { name: "next self-contact" }).click();
            assert.equal(await slider.inputValue(), "40");
            // Plots show the contact between the two frames, too.
            await page.getByRole("tab", { name: "Plots" }).click();
            assert.equal(await page.locator(".plot").nth(0).locator(".span").count(), 2);
        }));

    test("shows no verdict for frames without recorded collisions", () =>
        look({ change: (scene) => delete scene.playback.pairs_since }, async (page) => {
            await page.getByRole("slider", { name: "frame" }).fill("25");
            await settled(page);
            const text = await page.locator(".verdict-text").innerText();
            assert.equal(text, "unknown: collisions of this frame were not recorded");
        }));

    test("moves each body by its q and its own rigid motion", () =>
        look({}, async (page) => {
            await page.getByRole("slider", { name: "frame" }).fill("30");
            await settled(page);
            const place = await page.evaluate(() => {
                const mesh = globalThis.sscc.stage.bodies[0].group.children[0];
                const matrix = globalThis.sscc.stage.camera.matrix.clone();
                mesh.getMatrixAt(2, matrix);
                return matrix.elements;
            });
            // Body 3 at t = 1: turned by 0.8 about z, at (1.2, 0, 1.25).
            const due = [
                Math.cos(0.8),
                Math.sin(0.8),
                0,
                0,
                -Math.sin(0.8),
                Math.cos(0.8),
                0,
                0,
                0,
                0,
                1,
                0,
                1.2,
                0,
                1.25,
                1,
            ];
            for (const [i, value] of due.entries()) assert.ok(Math.abs(place[i] - value) < 1e-6, `${i}: ${place[i]}`);
        }));

    test("is saved as GLB; three.js plays the same positions", () =>
        look({}, async (page) => {
            const button = page.getByRole("button", { name: "save the motion" });
            const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
            const glb = await parse(readFileSync(await download.path()));
            assert.ok(isBounded(glb));
            const { shapes, box } = await page.evaluate(() => {
                const { shape } = globalThis.sscc;
                const frame = 30;
                const q = [0, 1, 2].map((b) => [0.4 * Math.sin(6 + b), 0, 0.2 * Math.cos(5), 0]);
                return { shapes: q.map((row) => [...shape.deformed(row)]), frame, box: 2 * shape.radius };
            });
            const meshes = [0, 1, 2].map((b) => atTime(glb, 1, `tube_${b + 1}`));
            shapes.forEach((x, b) => {
                // R (p + U q) + x at one second: a turn about z.
                const [c, s] = [Math.cos(0.4 + 0.2 * b), Math.sin(0.4 + 0.2 * b)];
                for (let v = 0; v < x.length; v += 3) {
                    const due = [c * x[v] - s * x[v + 1] + 1.2 * (b - 1), s * x[v] + c * x[v + 1], x[v + 2] + 1.25];
                    for (let i = 0; i < 3; i++) assert.ok(Math.abs(meshes[b][v + i] - due[i]) < 1e-5 * box);
                }
            });
        }));

    test("a slider leaves the recording, a button returns to it", () =>
        look({}, async (page) => {
            await page.locator('.mode input[type="range"]').first().fill("0.5");
            assert.equal(await page.evaluate(() => globalThis.sscc.stage.bodies[0].instances), 1);
            await settled(page);
            assert.match(await page.locator(".verdict-text").innerText(), /not checked/);
            await page.getByRole("button", { name: "back to the recording" }).click();
            assert.equal(await page.evaluate(() => globalThis.sscc.stage.bodies[0].instances), 3);
        }));

    const loadRows = async (page, rows) => {
        await page.keyboard.press("l");
        await page.getByRole("textbox", { name: "numbers" }).fill(rows.map((row) => row.join(" ")).join("\n"));
        await page.getByRole("button", { name: "Show", exact: true }).click();
        await page.locator(".dialog").waitFor({ state: "detached" });
        await page.evaluate(() => globalThis.player.timeline.pause());
    };

    test("loaded rows are shown in place of the recording, a button returns to it", () =>
        look({ sound: true }, async (page) => {
            const slider = page.getByRole("slider", { name: "frame" });
            const verdict = page.locator(".verdict-text");
            const cursor = page.locator(".plot").first().locator(".cursor");
            const instances = () => page.evaluate(() => globalThis.sscc.stage.bodies[0].instances);
            await slider.fill("25");
            assert.equal(await cursor.getAttribute("visibility"), "visible");
            // More rows than the recording has frames.
            const rows = Array.from({ length: 90 }, (_, i) => [i < 80 ? 0 : i / 100, 0, 0, 0]);
            await loadRows(page, rows);
            for (const [row, text] of [
                [10, "free: proven by the root's certificate"],
                [85, "not checked: this is a report"],
            ]) {
                await slider.fill(String(row));
                await settled(page);
                assert.equal(await verdict.innerText(), text);
                assert.deepEqual(await page.evaluate(() => [...globalThis.sscc.pose.q]), rows[row]);
                assert.equal(await instances(), 1);
                assert.equal(orange(await pixels(page)), 0);
                assert.equal(await cursor.getAttribute("visibility"), "hidden");
            }
            const [drawn, due] = [drawnBox(await pixels(page)), await expectedBox(page)];
            for (const side of ["top", "bottom"])
                assert.ok(Math.abs(drawn[side] - due[side]) < 4, `${side}: ${drawn[side]}, ${due[side]}`);
            // Other rows, and a slider, stay beside the recording.
            await loadRows(page, rows.slice(80));
            await page.locator('.mode input[type="range"]').first().fill("0.5");
            await page.getByRole("button", { name: "back to the recording" }).click();
            assert.equal(await instances(), 3);
            assert.equal(await slider.getAttribute("max"), "59");
            await settled(page);
            assert.equal(await verdict.innerText(), "free (as recorded)");
            assert.ok(await page.getByRole("button", { name: "back to the recording" }).isHidden());
            await slider.fill("25");
            await settled(page);
            assert.equal(await verdict.innerText(), "COLLIDING 10 pairs (as recorded)");
            assert.ok(orange(await pixels(page)) > 30);
        }));

    /** A recording of one body that only deforms, as that of the demo. */
    const posed = (scene, arrays) => {
        const { playback } = scene;
        playback.bodies = [{ ...playback.bodies[1], rigid: null }];
        playback.ground = null;
        const { pairs } = playback.bodies[0];
        const sizes = pairs.map((count) => (count > 0 ? 40 : 0));
        let end = 0;
        arrays.offsets = base64(new Uint32Array([0, ...sizes.map((size) => (end += size))]));
    };

    test("loaded rows do not have the marks of a recorded shape", () =>
        look({ change: posed }, async (page) => {
            const slider = page.getByRole("slider", { name: "frame" });
            const verdict = page.locator(".verdict-text");
            const marked = () => page.evaluate(() => globalThis.sscc.body.markedTriangles(0).length);
            const recorded = async () => {
                await slider.fill("25");
                await settled(page);
                assert.equal(await verdict.innerText(), "COLLIDING 10 pairs (as recorded)");
                assert.equal(await marked(), 40);
            };
            await recorded();
            const rows = [
                [0, 0, 0, 0],
                [0, 0.5, 0, 0],
            ];
            await loadRows(page, rows);
            await slider.fill("1");
            await settled(page);
            assert.equal(await verdict.innerText(), "not checked: this is a report");
            assert.equal(await marked(), 0);
            assert.deepEqual(await page.evaluate(() => [...globalThis.sscc.pose.q]), rows[1]);
            await page.getByRole("button", { name: "back to the recording" }).click();
            await recorded();
        }));

    test("a slider ends the playback of a recorded shape", () =>
        look({ change: posed }, async (page) => {
            await page.evaluate(() => globalThis.player.timeline.start());
            await page.waitForFunction(() => globalThis.player.timeline.frame > 3);
            await page.locator('.mode input[type="range"]').nth(1).fill("0.5");
            const q = await page.evaluate(() => [...globalThis.sscc.pose.q]);
            assert.equal(q[1], 0.5);
            assert.ok(!(await page.evaluate(() => globalThis.player.timeline.playing)));
            await page.waitForTimeout(200);
            assert.deepEqual(await page.evaluate(() => [...globalThis.sscc.pose.q]), q);
        }));

    test("sound and picture are in sync", () =>
        look({ sound: true }, async (page) => {
            await page.evaluate(() => document.querySelector(".play").click());
            // In one evaluation, since the recording lasts only two seconds.
            const apart = await page.evaluate(async () => {
                const { timeline } = globalThis.player;
                const audio = document.querySelector("audio");
                const frame = () => new Promise((done) => requestAnimationFrame(done));
                while (audio.currentTime < 0.7) await frame();
                const apart = audio.currentTime - timeline.track.times[timeline.frame];
                document.querySelector(".play").click();
                return apart;
            });
            // A recorded frame lasts 0.033 s; a slow picture may be a few frames late.
            assert.ok(Math.abs(apart) < 0.25, `${apart} s apart`);
            assert.ok(await page.evaluate(() => document.querySelector("audio").paused));
        }));
});

describe("the page", () => {
    test("plots with logarithmic axes, legends and a reading at the pointer", () =>
        look({}, async (page) => {
            await page.getByRole("tab", { name: "Plots" }).click();
            const titles = await page.locator(".plot figcaption").allInnerTexts();
            assert.deepEqual(titles, [
                "Cost over time",
                "Energy and displacement",
                "Radius of certificates per level: tube",
            ]);
            const ticks = await page.locator(".plot").nth(1).locator(".tick").allTextContents();
            for (const tick of ["0.01", "0.1", "1", "10", "1e-6", "0.001"])
                assert.ok(ticks.includes(tick), `${tick}: ${ticks}`);
            assert.equal(await page.locator(".plot").nth(0).locator(".span").count(), 2);
            await page.locator(".plot").nth(1).locator("svg[role=img]").hover();
            assert.match(
                await page.locator(".readout").nth(1).innerText(),
                /amplitude .*: energy metric .*, displacement metric/,
            );
            await page.getByRole("slider", { name: "frame" }).fill("30");
            assert.equal(await page.locator(".plot").nth(0).locator(".cursor").getAttribute("visibility"), "visible");
        }));

    test("plots numbers that differ only by rounding, and the smallest and largest ones", () => {
        const values = [
            [1, 1 + 2 ** -52],
            [12.5, 12.500000000000002],
            [-0.1, -0.10000000000000002],
            [5e-324, 5e-324],
            [5e-324, 1e-323],
            [1.5e308, 1.5e308],
        ];
        const plots = values.flatMap((y) =>
            [false, true].map((log) => ({
                title: `${y} ${log}`,
                x: { label: "step", log: false },
                y: { label: "energy", log },
                series: [{ name: "energy", x: [0, 1], y }],
            })),
        );
        // A range beyond the largest number has no linear axis.
        const drawn = plots.filter(({ y, series }) => y.log || series[0].y[0] < 1e308);
        return look({ playback: false, change: (scene) => (scene.plots = drawn) }, async (page) => {
            await page.getByRole("tab", { name: "Plots" }).click();
            const ticks = await page
                .locator(".plot")
                .evaluateAll((all) => all.map((plot) => plot.querySelectorAll(".tick").length));
            assert.equal(ticks.length, drawn.length + 1);
            assert.ok(
                ticks.every((count) => count > 4 && count < 30),
                `${ticks}`,
            );
        });
    });

    test("shows extremal deformations; a click displays one", () =>
        look({ playback: false }, async (page) => {
            await page.getByRole("tab", { name: "Certificates" }).click();
            const pictures = page.locator(".thumbnail");
            assert.equal(await pictures.count(), 4);
            // Modes are numbered from 0, as in the command.
            assert.equal(await pictures.nth(2).innerText(), "mode 2 +");
            await settled(page);
            const box = drawnBox(await pixels(page, ".thumbnail:nth-child(1) canvas"));
            assert.ok(box.count > 200, `${box.count} pixels`);
            await pictures.nth(2).click();
            assert.deepEqual(await page.evaluate(() => [...globalThis.sscc.pose.q]), [0, 0, 0.8, 0]);
        }));

    test("is usable by keys: help, tabs, names of all controls", () =>
        look({}, async (page) => {
            await page.keyboard.press("?");
            await page.getByRole("dialog", { name: "help" }).waitFor();
            // A report without checks has no pairs, and no server.
            const keys = await page.locator(".keys kbd").allInnerTexts();
            assert.ok(keys.includes("V") && keys.includes("?"), `${keys}`);
            assert.deepEqual(
                keys.filter((key) => ["C", "K", "B", "N, Shift+N", "H"].includes(key)),
                [],
            );
            await page.keyboard.press("Escape");
            await page.locator("dialog").waitFor({ state: "detached" });
            await page.getByRole("tab", { name: "Modes" }).focus();
            await page.keyboard.press("ArrowRight");
            assert.equal(await page.getByRole("tab", { name: "Certificates" }).getAttribute("aria-selected"), "true");
            const outline = await page.evaluate(() => getComputedStyle(document.activeElement).outlineStyle);
            assert.equal(outline, "solid");
            assert.deepEqual(await nameless(page), []);
        }));

    test("fits the width of a phone, in light and dark", async () => {
        for (const scheme of ["light", "dark"]) {
            await look({ width: 390, height: 844, scheme }, async (page) => {
                for (const tab of ["Modes", "Certificates", "Plots", "About"]) {
                    await page.getByRole("tab", { name: tab }).click();
                    assert.ok((await page.evaluate(() => document.scrollingElement.scrollWidth)) <= 390, tab);
                }
                assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), scheme);
                await page.keyboard.press("t");
                assert.notEqual(await page.evaluate(() => document.documentElement.dataset.theme), scheme);
            });
        }
    });

    test("opens the core within it again after an error", () => {
        // A package that cannot be opened at first, and then finds nothing.
        const script = `
            var isBroken = true;
            const ssccPackage = async () => {
                if (isBroken) throw new Error("the package has no memory");
            };
            ssccPackage.Model = { load: () => ({}) };
            ssccPackage.Certificates = { load: () => ({ rootRadius: 0.1 }) };
            ssccPackage.Query = class {
                discreteAtMost() {
                    return new Uint32Array();
                }
                get statistics() {
                    return { norm: 0.5, rootCertified: false, proof: "search", complete: true, free() {} };
                }
            };`;
        const checks = { script, module: "none", model: "none", certificates: "none" };
        const change = (_, arrays) => {
            arrays.none = deflateSync("").toString("base64");
        };
        return look({ playback: false, checks, change }, async (page) => {
            const verdict = page.locator(".verdict-text");
            const slider = page.locator('.mode input[type="range"]').first();
            await slider.fill("0.5");
            await page.getByText("the package has no memory").waitFor();
            await settled(page);
            assert.equal(await verdict.innerText(), "unknown: no answer");
            await page.evaluate(() => (globalThis.isBroken = false));
            await slider.fill("0.6");
            await page.getByText("free: proven", { exact: true }).waitFor();
        });
    });

    test("without a shape has only plots, in its whole width", () =>
        look({ playback: false, width: 1280, change: (scene) => (scene.models = []) }, async (page) => {
            assert.equal(await page.locator(".plot").count(), 1);
            assert.equal(await page.locator("canvas").count(), 0);
            assert.equal((await page.locator(".panel").boundingBox()).width, 1280);
        }));

    test("shows text as text", () =>
        look({ change: (scene) => (scene.title = "</script><img src=x onerror=alert(1)>") }, async (page) => {
            assert.equal(await page.locator("h1").innerText(), "</script><img src=x onerror=alert(1)>");
        }));

    test("works without WebGL, and says that it is missing", async () => {
        const without = await launch(["--disable-3d-apis"]);
        try {
            const { page, errors } = await open(without, write("none", { playback: false }));
            assert.match(await page.getByRole("alert").first().innerText(), /WebGL 2 is missing/);
            await page.locator('.mode input[type="range"]').first().fill("0.5");
            assert.equal(await page.evaluate(() => globalThis.sscc.pose.q[0]), 0.5);
            await page.getByRole("tab", { name: "Plots" }).click();
            assert.ok((await page.locator(".plot").count()) >= 2);
            assert.deepEqual(errors, []);
        } finally {
            await without.close();
        }
    });
});
