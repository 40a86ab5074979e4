// Chromium as it is installed; none is downloaded.
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const here = dirname(fileURLToPath(import.meta.url));
export const builtPage = join(here, "../../crates/sscc-view/page/index.html");
/** Drawing without a graphics card takes its time on a busy machine (ms). */
const PATIENCE = 240_000;

const places = [
    process.env.SSCC_CHROMIUM,
    "/usr/bin/chromium",
    "/usr/bin/chromium-browser",
    "/usr/bin/google-chrome",
];

/** Draws by the processor (SwiftShader), so that it needs no graphics card. */
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

/** A page of its own that notes what goes wrong in it, and every request. */
export async function open(browser, address, { width = 900, height = 560, scheme = "light", ...more } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, ...more });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const seen = { errors: [], requests: [] };
    page.on("pageerror", (error) => seen.errors.push(String(error)));
    page.on("console", (line) => line.type() === "error" && seen.errors.push(line.text()));
    page.on("request", (request) => seen.requests.push(request.url()));
    await page.goto(address);
    await page.waitForFunction(() => document.documentElement.dataset.ready === "true");
    return { page, context, ...seen };
}

/** What can be pressed or filled in and has no name for those who do not see it. */
export function nameless(page) {
    return page.evaluate(() =>
        [...document.querySelectorAll("button, input, select, textarea, canvas[tabindex]")]
            .filter((e) => !(e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.length))
            .map((e) => e.outerHTML),
    );
}
