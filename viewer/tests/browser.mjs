// Starts the installed Chromium; no browser is downloaded.
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const here = dirname(fileURLToPath(import.meta.url));
export const builtPage = join(here, "../../crates/sscc-view/page/index.html");
/** Timeout of each step (ms): drawing without a graphics card is slow on a busy machine. */
const TIMEOUT = 240_000;

const places = [
    process.env.SSCC_CHROMIUM,
    "/usr/bin/chromium",
    "/usr/bin/chromium-browser",
    "/usr/bin/google-chrome",
];

/** Starts Chromium. The processor draws (SwiftShader), so no graphics card is needed. */
export function launch(more = []) {
    const executablePath = places.find((place) => place && existsSync(place));
    if (!executablePath) throw new Error("no Chromium: install Debian's package, or name one in SSCC_CHROMIUM");
    const args = [
        "--no-sandbox",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--ignore-gpu-blocklist",
        "--autoplay-policy=no-user-gesture-required",
        ...more,
    ];
    return chromium.launch({ executablePath, headless: true, args });
}

/** Opens a page in a new context; returns it with its errors and requests. */
export async function open(browser, address, { width = 900, height = 560, scheme = "light", ...more } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, ...more });
    context.setDefaultTimeout(TIMEOUT);
    const page = await context.newPage();
    const seen = { errors: [], requests: [] };
    page.on("pageerror", (error) => seen.errors.push(String(error)));
    page.on("console", (line) => line.type() === "error" && seen.errors.push(line.text()));
    page.on("request", (request) => seen.requests.push(request.url()));
    await page.goto(address);
    await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
    return { page, context, ...seen };
}

/** Controls without an accessible name. */
export function nameless(page) {
    return page.evaluate(() =>
        [...document.querySelectorAll("button, input, select, textarea, canvas[tabindex]")]
            .filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.length))
            .map((e) => e.outerHTML),
    );
}

/** Waits until the live page shows the answer for its shape. */
export function answered(page) {
    return page.waitForFunction(() => {
        const { checker, pose } = globalThis.sscc;
        const gauge = document.querySelector(".gauge").dataset;
        return (
            checker.answer?.serial === pose.serial &&
            gauge.kind !== "checking" &&
            gauge.serial === String(pose.serial)
        );
    });
}
