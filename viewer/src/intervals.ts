/** Intervals of collision: marks under the slider of each mode, with the curve of the penetration depth. */
import type { App } from "./app";
import { count, digits, h, svg } from "./dom";
import type { ModeRow } from "./mode-row";
import { fade, ModeSearch } from "./mode-search";
import type { Intervals } from "./protocol";

const WIDTH = 1000;
const HEIGHT = 24;

/** The button that searches the intervals of the listed modes. */
export function intervalSearch(app: App, rows: ModeRow[], listed: () => number[]): HTMLElement {
    const search = new ModeSearch<Intervals>(
        app,
        rows,
        listed,
        {
            path: "/api/intervals",
            label: "Mark collisions",
            title: "mark the weights of each listed mode at which the shape collides, and how deep, with the other weights as displayed",
            done: "marked",
            cell: (row) => row.marks,
            show: (mode, found, base) => [marks(app, mode, found, base)],
            check: () => {},
        },
        () => {},
    );
    return h("div", { class: "sweeps" }, search.button, search.state);
}

/** Shows the intervals that a report has, which were found with these other weights. */
export function showMarks(app: App, rows: ModeRow[], all: Intervals[], base: Float64Array): void {
    const modes = [...all.keys()].filter((mode) => mode < rows.length);
    for (const mode of modes) rows[mode].marks.replaceChildren(marks(app, mode, all[mode], base));
    app.pose.onChange(() => fade(app, base, modes, (mode) => rows[mode].marks));
}

/** At most about two samples for each unit of the width: the first and the deepest of each stretch. */
function thinned(samples: Intervals["samples"]): Intervals["samples"] {
    const step = Math.max(1, Math.ceil(samples.length / WIDTH));
    if (step === 1) return samples;
    const kept: Intervals["samples"] = [];
    for (let i = 0; i < samples.length; i += step) {
        const stretch = samples.slice(i, i + step);
        const deepest = stretch.reduce((a, b) => (b[2] > a[2] ? b : a));
        kept.push(...(deepest === stretch[0] ? [deepest] : [stretch[0], deepest]));
    }
    return kept;
}

/**
 * The marks of one mode along its slider: where it collides, and the depth at each sample. A click on an interval shows its
 * weight with the largest depth.
 */
function marks(app: App, mode: number, found: Intervals, base: Float64Array): HTMLElement {
    const [low, high] = app.shape.range(mode);
    const x = (weight: number): number => (WIDTH * (weight - low)) / (high - low);
    const deepest = [
        ...found.samples.map(([, , depth]) => depth),
        ...found.intervals.map(({ depth }) => depth),
    ].reduce((most, depth) => Math.max(most, depth), 0);
    const picture = svg("svg", {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        preserveAspectRatio: "none",
        "aria-hidden": "true",
    });
    for (const { from, to, exact } of found.intervals) {
        const width = Math.max(4, x(to) - x(from));
        picture.append(
            svg("rect", { class: exact ? "mark" : "mark unproven", x: x(from), y: 0, width, height: HEIGHT }),
        );
    }
    if (deepest > 0) {
        const points = thinned(found.samples).map(
            ([weight, , depth]) =>
                `${x(weight).toFixed(1)} ${(HEIGHT - 1 - ((HEIGHT - 2) * depth) / deepest).toFixed(1)}`,
        );
        picture.append(svg("path", { class: "depth", d: `M${points.join("L")}` }));
    }
    const name = app.shape.modeName(mode);
    if (found.intervals.length === 0)
        return h("span", { class: "free-marks", title: `${name}: proven free from ${low} to ${high}` }, picture);
    const buttons = found.intervals.map(({ from, to, pairs, depth, deepest, exact }) => {
        const range = `from ${digits(from)} to ${digits(to)}`;
        const where = `collides ${range}: up to ${count(pairs, "pair")}, depth ${digits(depth)} at ${digits(deepest)}`;
        const maybe = exact ? "" : "; near an end it may be free";
        const text = pairs === 0 ? `nothing is proven ${range}, no sample collides` : where + maybe;
        const at = (100 * (x(from) + x(to))) / 2 / WIDTH;
        const width = Math.max(1, (100 * (x(to) - x(from))) / WIDTH);
        const show = (): void => {
            app.takeOver();
            const q = base.slice();
            q[mode] = deepest;
            app.pose.show(q);
        };
        const style = `left: ${(at - width / 2).toFixed(2)}%; width: ${width.toFixed(2)}%`;
        return h("button", {
            type: "button",
            class: "interval",
            style,
            title: text,
            "aria-label": `${name} ${text}; show it`,
            onclick: show,
        });
    });
    return h("span", { class: "collision-marks" }, picture, ...buttons);
}
