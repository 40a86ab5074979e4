// The live page with the real server, for the spring of the demo.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { request } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import { answered, launch, nameless, open } from "./browser.mjs";
import { readRows, run, view } from "./command.mjs";
import { atTime, isBounded, parse } from "./glb.mjs";
import { drawnBox, orange, pixels, settled, yellow } from "./picture.mjs";

const folder = mkdtempSync(join(tmpdir(), "sscc-view-"));
const model = join(folder, "spring.model.safetensors");
const certificates = join(folder, "spring.sscc.safetensors");
let browser;
let server;
let rows;
/** The answer of `sscc check --json` for each row. */
let answers;

before(async () => {
    await run("demo", "--out", folder);
    rows = readRows(join(folder, "spring.npy"));
    const trajectory = join(folder, "spring.npy");
    const lines = await run("check", model, "--certificates", certificates, "--trajectory", trajectory, "--json");
    answers = lines
        .trim()
        .split("\n")
        .map((line) => JSON.parse(line));
    server = await view(model, "--certificates", certificates);
    browser = await launch();
});
after(async () => {
    await browser?.close();
    await server?.stop();
    rmSync(folder, { recursive: true, force: true });
});

/** Opens the live page and runs the steps. Fails after an error of the page or a request to another address. */
async function look(steps, { allowed = [] } = {}) {
    const { page, context, errors, requests } = await open(browser, server.address, {});
    try {
        await steps(page, context);
        const unexpected = errors.filter((error) => !allowed.some((pattern) => pattern.test(error)));
        assert.deepEqual(unexpected, []);
        const elsewhere = requests.filter(
            (url) => !url.startsWith(`${server.origin}/`) && !/^(blob|data):/.test(url),
        );
        assert.deepEqual(elsewhere, []);
    } finally {
        await context.close();
    }
}

const show = (page, q) => page.evaluate((q) => globalThis.sscc.pose.show(q), q);
const verdict = (page) => page.locator(".verdict-text").innerText();
/** The first row whose answer satisfies the condition. */
const row = (wanted) => {
    const index = answers.findIndex(wanted);
    assert.ok(index >= 0, "the demo has such a row");
    return { q: rows[index], answer: answers[index] };
};
const fewPairs = () => row((a) => a.colliding && a.count < 400);

describe("live", () => {
    test("loads, removes the token from the address, and reloads", () =>
        look(async (page) => {
            assert.ok(!page.url().includes("token"));
            await answered(page);
            assert.ok(drawnBox(await pixels(page)).count > 2000);
            assert.match(await page.locator(".subtitle").innerText(), /16,000 triangles, 20 modes/);
            assert.deepEqual(await nameless(page), []);
            await page.keyboard.press("l");
            await page.getByRole("dialog", { name: "load q" }).waitFor();
            assert.deepEqual(await nameless(page), []);
            await page.reload();
            await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
            await answered(page);
            assert.match(await page.locator(".subtitle").innerText(), /16,000 triangles, 20 modes/);
        }));

    test("the gauge shows the answer of check", () =>
        look(async (page) => {
            for (const wanted of [
                (a) => a.root_certified,
                (a) => !a.colliding && !a.root_certified,
                (a) => a.colliding,
            ]) {
                const { q, answer } = row(wanted);
                await show(page, q);
                await answered(page);
                const pairs = `COLLIDING ${answer.count.toLocaleString("en")} pair${answer.count === 1 ? "" : "s"}`;
                const by = answer.root_certified ? " by the root's certificate alone" : "";
                const free = `free: proven${by}, apart from pairs with common vertices`;
                assert.equal(await verdict(page), answer.colliding ? pairs : free);
                const norm = await page.evaluate(() => globalThis.sscc.checker.answer.norm);
                assert.equal(norm, answer.norm);
            }
        }));

    test("the gauge shows root-certified q in the frame that draws them, and agrees with the server", () =>
        look(async (page) => {
            await show(page, fewPairs().q);
            await answered(page);
            // q of one length in the metric along several directions, just inside the root's radius and just outside.
            const ball = await page.evaluate(() => {
                const { root_radius, scales, rank } = globalThis.sscc.shape.model;
                const directions = [0, 1, 2, 3].map((d) => scales.map((_, k) => Math.sin(1 + d + k * (d + 1))));
                directions.push(...[0, rank - 1].map((only) => scales.map((_, k) => Number(k === only))));
                return directions.flatMap((z) =>
                    [0.5, 1 - 1e-9, 1 + 1e-9].map((share) => ({
                        share,
                        q: z.map((v, k) => (v * share * root_radius) / Math.hypot(...z) / scales[k]),
                    })),
                );
            });
            for (const { q, share } of ball) {
                await show(page, q);
                await answered(page);
                const certified = await page.evaluate(() => globalThis.sscc.checker.answer.root_certified);
                assert.equal(certified, share < 1);
                assert.equal(await page.locator(".gauge").getAttribute("data-kind"), share < 1 ? "root" : "free");
            }
            await show(page, fewPairs().q);
            await answered(page);
            await page.route("**/api/check", () => undefined);
            // Within one frame, and without an answer.
            const seen = await page.evaluate(async (q) => {
                const { pose, body } = globalThis.sscc;
                pose.show(q);
                await new Promise((done) => requestAnimationFrame(done));
                const gauge = document.querySelector(".gauge").dataset;
                return {
                    kind: gauge.kind,
                    isOf: gauge.serial === String(pose.serial),
                    marks: body.markedTriangles(0),
                };
            }, ball[0].q);
            assert.deepEqual(seen, { kind: "root", isOf: true, marks: [] });
        }));

    test("the marked triangles are those of check", () =>
        look(async (page) => {
            const { q, answer } = fewPairs();
            assert.equal(orange(await pixels(page)), 0);
            await show(page, q);
            await answered(page);
            const marked = await page.evaluate(() => globalThis.sscc.body.markedTriangles(0));
            const due = [...new Set(answer.pairs.flat())].sort((a, b) => a - b);
            assert.deepEqual(marked, due);
            await settled(page);
            assert.ok(orange(await pixels(page)) > 10);
            await page.getByRole("tab", { name: "Collisions" }).click();
            const listed = await page.locator(".pair").allInnerTexts();
            assert.deepEqual(
                listed,
                answer.pairs.slice(0, 100).map(([i, j]) => `${i} – ${j}`),
            );
            const first = page.locator(".pair").first();
            await first.click();
            // The camera flies until the pair is in the middle of the picture.
            await page.waitForFunction(() => {
                const { shape, pose, checker, stage } = globalThis.sscc;
                const { middle } = shape.around(checker.answer.pairs[0], pose.q);
                const point = stage.camera.position
                    .clone()
                    .set(...middle)
                    .project(stage.camera);
                return Math.hypot(point.x, point.y) < 0.02;
            });
            // N continues from the pair that was clicked.
            await page.keyboard.press("n");
            const chosen = await page.locator('.pair[aria-pressed="true"]').allInnerTexts();
            assert.deepEqual(chosen, [listed[1 % listed.length]]);
            await page.keyboard.press("?");
            const keys = await page.locator(".keys kbd").allInnerTexts();
            assert.ok(
                ["C", "K", "B", "N, Shift+N"].every((key) => keys.includes(key)),
                `${keys}`,
            );
            await page.keyboard.press("Escape");
            await page.locator("dialog").waitFor({ state: "detached" });
            await page.keyboard.press("r");
            await answered(page);
            assert.deepEqual(await page.evaluate(() => globalThis.sscc.body.markedTriangles(0)), []);
        }));

    test("an answer counts only for its own q; only the latest waiting q is sent", () =>
        look(async (page) => {
            await answered(page);
            let release;
            const held = new Promise((done) => {
                release = done;
            });
            const serials = [];
            await page.route("**/api/check", async (route) => {
                serials.push(route.request().postDataJSON().serial);
                await held;
                await route.continue();
            });
            const free = row((a) => a.root_certified).q;
            for (let i = 0; i < 6; i++)
                await show(
                    page,
                    free.map((v) => v * (1 - i / 10)),
                );
            await show(page, fewPairs().q);
            await settled(page);
            assert.equal(await verdict(page), "checking…");
            assert.equal(serials.length, 1);
            release();
            await answered(page);
            assert.match(await verdict(page), /^COLLIDING/);
            assert.equal(serials.length, 2);
            assert.equal(serials[1], await page.evaluate(() => globalThis.sscc.pose.serial));
        }));

    test("there are answers while the mouse drags a slider", () =>
        look(async (page) => {
            await answered(page);
            const slider = page.locator('.mode input[type="range"]').nth(1);
            const box = await slider.boundingBox();
            const y = box.y + box.height / 2;
            await page.mouse.move(box.x + box.width / 2, y);
            await page.mouse.down();
            const kinds = new Set();
            for (let i = 1; i <= 12; i++) {
                await page.mouse.move(box.x + (box.width * (12 + i)) / 24, y);
                await answered(page);
                kinds.add(await page.locator(".gauge").getAttribute("data-kind"));
            }
            await page.mouse.up();
            const q = await page.evaluate(() => [...globalThis.sscc.pose.q]);
            assert.ok(q[1] > 0 && q.every((v, k) => k === 1 || v === rows[0][k] || v === 0));
            assert.ok(kinds.has("colliding"), [...kinds].join(", "));
        }));

    test("moves along a mode to the first self-collision, or says that there is none", () =>
        look(async (page) => {
            // The server finds which modes lead to a collision.
            const found = await page.evaluate(async () => {
                const { source, shape } = globalThis.sscc;
                const along = [];
                for (const k of shape.model.limits.keys()) {
                    const direction = shape.model.limits.map((_, i) => (i === k ? 1 : 0));
                    along.push(await source.ask("/api/safe_scale", { direction }));
                }
                return along;
            });
            assert.ok(found.every((answer) => answer.complete));
            const [mode, free] = [found.findIndex((a) => a.first), found.findIndex((a) => !a.first)];
            const press = (k) => page.getByRole("button", { name: `mode ${k} to the first self-collision` }).click();
            const message = async (text) => {
                await page.locator(".message", { hasText: text }).waitFor();
                return page.locator(".message").innerText();
            };
            assert.ok(mode >= 0 && free >= 0);
            await press(free);
            const none = await message(`no self-collision along mode ${free} up to`);
            assert.ok(!none.includes("time limit"), none);
            await press(mode);
            await message(`first self-collision along mode ${mode} at`);
            await page.waitForFunction(
                ([k, scale]) => globalThis.sscc.pose.q[k] === scale,
                [mode, found[mode].first.scale],
            );
            await answered(page);
            assert.match(await verdict(page), /^COLLIDING/);
            const check = async (q) => {
                const row = `--q=${q.join(",")}`;
                return JSON.parse(await run("check", model, "--certificates", certificates, "--json", row));
            };
            const q = await page.evaluate(() => [...globalThis.sscc.pose.q]);
            assert.ok((await check(q)).colliding);
            assert.ok(!(await check(q.map((v) => v * (1 - 1e-6)))).colliding);
        }));

    test("only the later of two searches counts", () =>
        look(async (page) => {
            let release;
            const held = new Promise((done) => {
                release = done;
            });
            await page.route(
                "**/api/safe_scale",
                async (route) => {
                    await held;
                    await route.continue();
                },
                { times: 1 },
            );
            await page.getByRole("button", { name: "mode 0 to the first self-collision" }).click();
            await page.getByRole("button", { name: "mode 1 to the first self-collision" }).click();
            const later = page.locator(".message", { hasText: /self-collision along mode 1 (at|up to)/ });
            await later.waitFor();
            const [answer] = await Promise.all([page.waitForResponse("**/api/safe_scale"), release()]);
            await answer.finished();
            await settled(page);
            assert.ok(!(await page.locator(".message").innerText()).includes("mode 0 "));
        }));

    test("the costs of both methods are shown", () =>
        look(async (page) => {
            const { q, answer } = fewPairs();
            await show(page, q);
            await page.getByRole("tab", { name: "Collisions" }).click();
            await page.waitForFunction(() => /×/.test(document.querySelector(".counters").textContent));
            const table = await page.locator(".counters").innerText();
            const n = answer.count.toLocaleString("en");
            assert.match(table, new RegExp(`pairs\\s+${n}\\s+${n}`));
            assert.match(table, new RegExp(`nodes opened\\s+${answer.opened.toLocaleString("en")}`));
        }));

    test("the numbers of a search that ended at its limit are lower bounds", () =>
        look(async (page) => {
            const { q, answer } = fewPairs();
            const n = answer.count.toLocaleString("en");
            // Only the answer by certificates is cut off, then only the other one.
            for (const [cutOff, other] of [
                ["check", "traditional"],
                ["traditional", "check"],
            ]) {
                await page.unrouteAll();
                await page.route(`**/api/${cutOff}`, async (route) => {
                    const response = await route.fetch();
                    const json = { ...(await response.json()), complete: false };
                    if (json.pairs) json.pairs = json.pairs.slice(0, 1);
                    await route.fulfill({ response, json });
                });
                const whole = page.waitForResponse(`**/api/${other}`);
                await show(page, q);
                assert.equal((await (await whole).json()).complete, true);
                await answered(page);
                await page.getByRole("tab", { name: "Collisions" }).click();
                const [own, traditional] = cutOff === "check" ? [`at least ${n}`, n] : [n, `at least ${n}`];
                await page.waitForFunction(() => /×/.test(document.querySelector(".counters").textContent));
                const table = await page.locator(".counters").innerText();
                assert.match(table, new RegExp(`pairs\\s+${own}\\s+${traditional}`));
                const heading = await page.getByRole("heading", { name: "colliding pairs" }).innerText();
                assert.equal(heading, `${cutOff === "check" ? "At least " : ""}${n} colliding pairs`);
                const rest = page.getByText(`the first 1 of at least ${n} pairs are listed`);
                assert.equal(await rest.count(), cutOff === "check" ? 1 : 0);
            }
        }));

    test("a colouring whose nodes arrive late does not replace a later choice; after an error nodes are requested again", () =>
        look(
            async (page) => {
                await answered(page);
                const isTinted = () =>
                    page.evaluate(() => globalThis.sscc.body.group.children[0].material.uniforms.tinted.value);
                await page.getByRole("tab", { name: "Certificates" }).click();
                const colours = page.getByLabel("colours");
                await page.route("**/api/nodes", (route) =>
                    route.fulfill({ status: 500, json: { error: "no nodes yet" } }),
                );
                await colours.selectOption("searched");
                await page.locator(".message", { hasText: "no nodes yet" }).waitFor();
                // Each answer asks again.
                await show(page, fewPairs().q);
                await answered(page);
                await page.locator(".message", { hasText: "no nodes yet" }).waitFor();
                await colours.selectOption("none");
                await page.unrouteAll();
                let release;
                const held = new Promise((done) => {
                    release = done;
                });
                await page.route("**/api/nodes", async (route) => {
                    await held;
                    await route.continue();
                });
                await colours.selectOption("radius");
                await colours.selectOption("none");
                const nodes = page.waitForResponse("**/api/array/**");
                release();
                await (await nodes).finished();
                await settled(page);
                assert.equal(await isTinted(), false);
                assert.ok(await page.locator(".ramp-legend").isHidden());
                await colours.selectOption("radius");
                await page.locator(".ramp").waitFor();
                assert.equal(await isTinted(), true);
            },
            { allowed: [/status of 500/] },
        ));

    test("loaded rows make way for a motion to the first self-collision", () =>
        look(async (page) => {
            await answered(page);
            const { rank } = await page.evaluate(() => globalThis.sscc.shape.model);
            const row = (i) => Array.from({ length: rank }, (_, k) => (k === rank - 1 ? 1e-6 * i : 0));
            await page.evaluate(
                (rows) => globalThis.sscc.playRows(rows),
                Array.from({ length: 3000 }, (_, i) => row(i)),
            );
            await page.waitForFunction(() => globalThis.player.timeline.frame > 3);
            await page.keyboard.press("c");
            await page.locator(".message", { hasText: /first self-collision along random direction 1 at/ }).waitFor();
            assert.equal(await page.evaluate(() => globalThis.player.timeline.playing), false);
            await page.locator(".verdict-text", { hasText: /^COLLIDING/ }).waitFor();
            assert.equal(await page.evaluate(() => globalThis.sscc.motion.name), null);
        }));

    test("nodes are coloured by radius, and as opened and culled; AABBs are drawn", () =>
        look(async (page) => {
            await show(
                page,
                fewPairs().q.map(() => 0),
            );
            await answered(page);
            await page.getByRole("tab", { name: "Certificates" }).click();
            const colours = async () => {
                await settled(page);
                const picture = await pixels(page);
                const seen = new Set();
                for (let y = 0; y < picture.height; y += 2) {
                    for (let x = 0; x < picture.width; x += 2)
                        seen.add(
                            picture
                                .at(x, y)
                                .map((c) => c >> 4)
                                .join(),
                        );
                }
                return seen.size;
            };
            const plain = await colours();
            assert.equal(yellow(await pixels(page)), 0);
            await page.getByLabel("colours").selectOption("radius");
            await page.locator(".ramp").waitFor();
            assert.ok((await colours()) > 1.3 * plain);
            await show(page, fewPairs().q);
            await page.getByLabel("colours").selectOption("searched");
            await page.getByText(/culled by certificates/).waitFor();
            const text = await page.locator(".ramp-legend").innerText();
            const [culled, opened] = text.match(/\d[\d,]*/g).map((n) => Number(n.replaceAll(",", "")));
            assert.ok(culled > 0 && opened > 0, text);
            await settled(page);
            assert.ok(yellow(await pixels(page)) > 100);
            await page.getByLabel("AABBs of this level").check();
            await page.waitForFunction(() => globalThis.sscc.stage.scene.children.some((c) => c.isLineSegments));
        }));

    test("a picture and the motion can be saved; three.js reads our positions", () =>
        look(async (page) => {
            const { q } = fewPairs();
            await show(page, q);
            await answered(page);
            const saved = async (button) => {
                const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
                return readFileSync(await download.path());
            };
            const png = await saved(page.getByRole("button", { name: "save a picture" }));
            assert.equal(png.subarray(1, 4).toString(), "PNG");
            assert.ok(png.length > 5000);
            const glb = await parse(await saved(page.getByRole("button", { name: "save the motion" })));
            assert.ok(isBounded(glb));
            // The line from the centre to q and back; q is reached at one second.
            for (const [time, share] of [
                [0, 0],
                [0.5, 0.5],
                [1, 1],
            ]) {
                const due = await page.evaluate(
                    (q) => [...globalThis.sscc.shape.deformed(q)],
                    q.map((v) => v * share),
                );
                const { min, max } = await page.evaluate(() => globalThis.sscc.shape.model.box);
                const box = Math.hypot(...max.map((v, c) => v - min[c]));
                const worst = atTime(glb, time).reduce((most, v, i) => Math.max(most, Math.abs(v - due[i])), 0);
                assert.ok(worst < 1e-5 * box, `at ${time} s: ${worst / box} of the box`);
            }
        }));
});

describe("the server", () => {
    /** A request of any program. */
    const ask = (path, { headers = {}, body } = {}) =>
        new Promise((done, failed) => {
            const url = new URL(path, server.origin);
            const sent = request(url, { method: body === undefined ? "GET" : "POST", headers }, (response) => {
                let text = "";
                response.on("data", (part) => (text += part));
                response.on("end", () => done({ status: response.statusCode, text }));
            });
            sent.on("error", failed);
            sent.end(body);
        });
    const token = () => ({ "X-Sscc-Token": server.token });
    const check = () => JSON.stringify({ q: rows[0], serial: 1 });

    test("refuses a wrong token, a foreign Origin or Host", async () => {
        assert.equal((await ask("/api/scene", { headers: token() })).status, 200);
        assert.equal((await ask("/api/scene")).status, 403);
        assert.equal((await ask("/api/scene", { headers: { "X-Sscc-Token": "0".repeat(64) } })).status, 403);
        assert.equal((await ask("/?token=wrong")).status, 403);
        const foreign = { ...token(), Origin: "http://example.com" };
        assert.equal((await ask("/api/check", { headers: foreign, body: check() })).status, 403);
        assert.equal((await ask("/api/scene", { headers: { ...token(), Host: "example.com" } })).status, 403);
    });

    test("refuses large bodies, q of a wrong length and unknown paths, in one line", async () => {
        const large = await ask("/api/check", { headers: token(), body: `{"q":[${"1,".repeat(1 << 20)}1]}` }).catch(
            () => null,
        );
        // The server may close the connection before the whole body is sent.
        if (large) assert.equal(large.status, 413);
        const long = await ask("/api/check", { headers: token(), body: '{"q":[1],"serial":1}' });
        assert.equal(long.status, 400);
        const { error } = JSON.parse(long.text);
        assert.ok(error.length > 10 && !error.includes("\n"), error);
        assert.equal((await ask("/api/nothing", { headers: token() })).status, 404);
    });

    test("a page with a wrong token shows an error", async () => {
        const context = await browser.newContext();
        const page = await context.newPage();
        await page.goto(server.origin);
        await page.getByRole("alert").waitFor();
        assert.match(await page.getByRole("alert").innerText(), /token/);
        await context.close();
    });

    test("a page of another site gets no answer", async () => {
        const context = await browser.newContext();
        const page = await context.newPage();
        await page.goto("data:text/html,<p>elsewhere");
        const result = await page.evaluate(
            ([url, token]) =>
                fetch(url, { method: "POST", headers: { "X-Sscc-Token": token }, body: "{}" }).then(
                    (response) => response.status,
                    () => "refused",
                ),
            [`${server.origin}/api/check`, server.token],
        );
        assert.equal(result, "refused");
        await context.close();
    });

    test("the page shows an error after the server has stopped, and no verdict", async () => {
        const own = await view(model, "--certificates", certificates);
        const { page, context } = await open(browser, own.address);
        await answered(page);
        await own.stop();
        await show(page, row((a) => !a.root_certified && !a.colliding).q);
        await page.getByText(/The server does not answer/).waitFor();
        await settled(page);
        assert.equal(await verdict(page), "unknown: no answer");
        await context.close();
    });
});

test("the demo's report plays", async () => {
    const { page, context, errors } = await open(browser, `file://${join(folder, "report.html")}`);
    await page.getByRole("tab", { name: "Plots" }).click();
    assert.ok((await page.locator(".plot").count()) >= 1);
    const slider = page.getByRole("slider", { name: "frame" });
    const colliding = answers.findIndex((a) => a.colliding);
    await slider.fill(String(colliding));
    await settled(page);
    assert.equal(await verdict(page), `COLLIDING ${answers[colliding].count} pairs (as recorded)`);
    assert.deepEqual(errors, []);
    await context.close();
});
