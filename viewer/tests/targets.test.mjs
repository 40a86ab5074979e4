// The live page of a rig with hundreds of morph targets: first collisions, and flights to pairs.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { answered, launch, nameless, open } from "./browser.mjs";
import { view } from "./command.mjs";
import { pixels, settled, yellowMarks } from "./picture.mjs";
import { BEHIND, rig, WITHIN } from "./rig.mjs";

const BULGES = 200;
const folder = mkdtempSync(join(tmpdir(), "sscc-targets-"));
let browser;
let server;

before(async () => {
    const file = join(folder, "rig.gltf");
    writeFileSync(file, rig(BULGES));
    server = await view(file);
    browser = await launch();
});
after(async () => {
    await browser?.close();
    await server?.stop();
    rmSync(folder, { recursive: true, force: true });
});

/** Opens the page and runs the steps. Fails after an error of the page. Flights of the camera take no time. */
async function look(steps, { allowed = /^$/ } = {}) {
    const { page, context, errors } = await open(browser, server.address, { reducedMotion: "reduce" });
    try {
        await steps(page);
        assert.deepEqual(
            errors.filter((error) => !allowed.test(error)),
            [],
        );
    } finally {
        await context.close();
    }
}

const q = (page) => page.evaluate(() => [...globalThis.sscc.pose.q]);
const show = (page, weights) =>
    page.evaluate((weights) => {
        const { pose } = globalThis.sscc;
        const q = new Float64Array(pose.q.length);
        q.set(weights);
        pose.show(q);
    }, weights);
const filter = (page, text) => page.getByRole("searchbox", { name: "filter by name" }).fill(text);
const find = (page) => page.getByRole("button", { name: "Find first collisions" }).click();
const found = (page) => page.locator(".first:not(:empty)");

test("first collisions are found row by row, for the modes of the filter", () =>
    look(async (page) => {
        const requested = [];
        page.on("request", (request) => {
            if (request.url().endsWith("/api/sweep")) requested.push(request.postDataJSON().mode);
        });
        await filter(page, "the ball wall");
        await find(page);
        await page.waitForFunction(() => document.querySelectorAll(".hit").length === 2);
        assert.deepEqual(requested, [0, 1]);
        // From 0, an end of the range, there is one direction.
        assert.deepEqual(await page.locator(".hit").allInnerTexts(), ["↑ 0.5000", "↑ 0.2500"]);
        assert.match(await page.locator(".hit").first().getAttribute("title"), /^proven free from 0 to 0\.49999999/);
        assert.deepEqual(await nameless(page), []);
        // A click shows the hit: it collides, and just before it the shape is free.
        await page.getByRole("button", { name: `${WITHIN} touches at` }).click();
        const weights = await q(page);
        assert.ok(Math.abs(weights[1] - 0.25) < 1e-6 && weights.every((w, k) => k === 1 || w === 0));
        await answered(page);
        assert.match(await page.locator(".verdict-text").innerText(), /^COLLIDING/);
        await show(page, [0, weights[1] - 1e-6]);
        await answered(page);
        assert.match(await page.locator(".verdict-text").innerText(), /^free/);
        // The other results hold for other weights: they are pale until these return.
        const opacities = (check) =>
            page.waitForFunction(
                `(${check})([...document.querySelectorAll(".first")].map((e) => Number(getComputedStyle(e).opacity)))`,
            );
        await opacities("([a, b]) => a < 0.6 && b === 1");
        await page.keyboard.press("r");
        await opacities("([a, b]) => a === 1 && b === 1");
        // Beside the other results, one that is free.
        await filter(page, "bulge_number_7_");
        await find(page);
        await page.getByText("↑ free").waitFor();
        assert.deepEqual(requested, [0, 1, 8]);
        await filter(page, "");
        await page.getByLabel("only modes that collide").check();
        assert.deepEqual(await page.locator(".mode:visible .mode-name").allInnerTexts(), [BEHIND, WITHIN]);
    }));

test("collisions are marked along the sliders, with their depths", () =>
    look(async (page) => {
        await filter(page, "the ball wall");
        // Also from a shape that collides.
        await show(page, [0, 0.4]);
        await page.getByRole("button", { name: "Mark collisions" }).click();
        await page.waitForFunction(() => document.querySelectorAll(".collision-marks").length === 2);
        const marks = page.locator(".interval");
        assert.equal(await marks.count(), 2);
        const titles = await marks.evaluateAll((all) => all.map((mark) => mark.title));
        // The first mode collides over all of its range, because of the second weight.
        assert.match(titles[0], /^collides from 0 to 1\.000: up to \d+ pairs, depth /);
        assert.match(titles[1], /^collides from 0\.2500 to 0\.5500: up to \d+ pairs, depth /);
        assert.deepEqual(await nameless(page), []);
        // The mark stands where the slider has these weights.
        const [slider, mark] = await Promise.all(
            [page.locator(".mode:visible input[type=range]").nth(1), marks.nth(1)].map((e) => e.boundingBox()),
        );
        const share = (mark.x - slider.x) / slider.width;
        assert.ok(share > 0.2 && share < 0.3, String(share));
        await marks.nth(1).click();
        const weights = await q(page);
        assert.ok(weights[1] > 0.25 && weights[0] === 0);
        // Pale where other weights than its own have changed.
        await show(page, [0.1, 0.4]);
        const opacities = await page
            .locator(".marks:not(:empty)")
            .evaluateAll((all) => all.map((e) => Number(getComputedStyle(e).opacity)));
        assert.deepEqual(opacities, [1, 0.45]);
    }));

test("a search can be stopped, and is refused from a shape that collides", () =>
    look(async (page) => {
        // The server never answers the third row.
        await page.route("**/api/sweep", (route) => {
            if (route.request().postDataJSON().mode < 2) return route.continue();
        });
        await find(page);
        await page.getByText(`2 of ${BULGES + 2} modes searched`).waitFor();
        assert.equal(await found(page).count(), 3);
        await page.getByRole("button", { name: "Stop" }).click();
        await page.getByText(`stopped after 2 of ${BULGES + 2} modes`).waitFor();
        assert.equal(await found(page).count(), 2);
        await show(page, [0.7]);
        await answered(page);
        await find(page);
        await page.getByText(/the displayed shape collides already/).waitFor();
    }));

test("one row without a result does not end the search", () =>
    look(
        async (page) => {
            await page.route(
                "**/api/sweep",
                (route) => route.fulfill({ status: 400, json: { error: "the search had no result within 10 s" } }),
                { times: 1 },
            );
            await filter(page, "wall");
            await find(page);
            await page.locator(".hit").waitFor();
            assert.deepEqual(await found(page).allInnerTexts(), ["no result", "↑ 0.2500"]);
            // The next search is for this row only. After a stop it is empty, as before the first search.
            const requested = [];
            let isHeld = true;
            await page.route("**/api/sweep", (route) => {
                requested.push(route.request().postDataJSON().mode);
                if (!isHeld) return route.continue();
            });
            await find(page);
            await page.getByText("0 of 1 modes searched").waitFor();
            await page.getByRole("button", { name: "Stop" }).click();
            await page.getByText("stopped after 0 of 1 modes").waitFor();
            assert.deepEqual(await found(page).allInnerTexts(), ["↑ 0.2500"]);
            isHeld = false;
            await find(page);
            await page.waitForFunction(() => document.querySelectorAll(".hit").length === 2);
            assert.deepEqual(await found(page).allInnerTexts(), ["↑ 0.5000", "↑ 0.2500"]);
            assert.deepEqual(requested, [0, 0]);
        },
        { allowed: /status of 400/ },
    ));

/** Opens the collisions of a shape, and flies to a pair. */
async function flyTo(page, weights, at) {
    await show(page, weights);
    await answered(page);
    await page.getByRole("tab", { name: "Collisions" }).click();
    await page.locator(".pair").nth(at).click();
    await settled(page);
}

test("a flight turns the camera, so that the pair is in front", () =>
    look(async (page) => {
        const side = () => page.evaluate(() => globalThis.sscc.stage.camera.position.z);
        assert.ok((await side()) > 5);
        await flyTo(page, [0.7], 0);
        // The pair is behind the ball, at z = -1.3; it is seen from the side or from behind.
        assert.ok((await side()) < 0, `${await side()}`);
        assert.ok(yellowMarks(await pixels(page)) > 300);
        await page.keyboard.press("h");
        await settled(page);
        // Nothing is in front of it.
        assert.ok(yellowMarks(await pixels(page)) > 300);
    }));

test("a flight cuts away what hides the pair", () =>
    look(async (page) => {
        await flyTo(page, [0, 0.4], 0);
        assert.ok(yellowMarks(await pixels(page)) > 300);
        await page.keyboard.press("h");
        await settled(page);
        assert.equal(yellowMarks(await pixels(page)), 0);
        await page.keyboard.press("h");
        // Also from other sides.
        await page.focus(".stage canvas");
        for (let i = 0; i < 7; i++) await page.keyboard.press("ArrowLeft");
        await settled(page);
        assert.ok(yellowMarks(await pixels(page)) > 100);
        // The whole shape is whole again.
        await page.keyboard.press("f");
        await settled(page);
        assert.equal(yellowMarks(await pixels(page)), 0);
    }));
