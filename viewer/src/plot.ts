/** Line plots as SVG, with linear or logarithmic axes. Lines differ in their dashes and in their colours. */
import { digits, h, svg } from "./dom";
import type { Axis, PlotData, Series } from "./protocol";

const WIDTH = 340;
const HEIGHT = 210;
const LEFT = 52;
const RIGHT = 10;
const TOP = 8;
const BOTTOM = 34;
/** Largest number of ticks on a linear axis; at the steps used there are at most 6. */
const MAX_TICKS = 20;
const DASHES = ["none", "6 3", "2 3", "8 3 2 3", "1 2", "10 4"];

export interface Plot {
    element: HTMLElement;
    /** Shows a vertical line at x, such as the current time. */
    setCursor(x: number | null): void;
}

interface Scale {
    low: number;
    high: number;
    ticks: number[];
    /** The position of a value on the axis, from 0 to 1. */
    at(value: number): number;
}

export function scaleOf(values: number[], log: boolean): Scale {
    const usable = values.filter((v) => Number.isFinite(v) && (!log || v > 0));
    let low = usable.reduce((a, b) => Math.min(a, b), Number.POSITIVE_INFINITY);
    let high = usable.reduce((a, b) => Math.max(a, b), Number.NEGATIVE_INFINITY);
    if (usable.length === 0) [low, high] = log ? [0.1, 1] : [0, 1];
    if (log) {
        // Neither 0 nor infinity: their logarithms are infinite.
        if (high / low < 4) [low, high] = [Math.max(low / 2, Number.MIN_VALUE), Math.min(high * 2, Number.MAX_VALUE)];
        const [a, b] = [Math.log10(low), Math.log10(high)];
        const ticks: number[] = [];
        const step = Math.max(1, Math.ceil((b - a) / 6));
        for (let e = Math.ceil(a - 1e-9); e <= b + 1e-9; e += step) ticks.push(10 ** e);
        if (ticks.length < 2) {
            for (let e = Math.floor(a); e <= b; e++) for (const m of [1, 2, 5]) ticks.push(m * 10 ** e);
        }
        const last = Math.min(high * 1.001, Number.MAX_VALUE);
        const shown = [...new Set(ticks)].filter((t) => t >= low * 0.999 && t <= last).sort((x, y) => x - y);
        return { low, high, ticks: shown, at: (v) => (Math.log10(v) - a) / (b - a) };
    }
    if (low > 0 && low < high / 2) low = 0;
    if (low === high) high = low + (Math.abs(low) || 1);
    const raw = (high - low) / 5;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw) ?? raw;
    const ticks: number[] = [];
    const first = Math.ceil(low / step - 1e-9);
    for (let i = 0; i < MAX_TICKS; i++) {
        // If the values differ only by rounding, first + i may round to the number before.
        const tick = (first + i) * step;
        if (!(tick <= high + step * 1e-9)) break;
        if (tick !== ticks.at(-1)) ticks.push(tick);
    }
    return { low, high, ticks, at: (v) => (v - low) / (high - low) };
}

function tickText(value: number): string {
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e5 || size < 1e-3) return value.toExponential(0).replace("e+", "e");
    return String(Number(value.toPrecision(3)));
}

/** Keeps at most two points for each column of pixels: the smallest and the largest. */
function thin(points: [number, number][]): [number, number][] {
    if (points.length <= 2 * WIDTH) return points;
    const columns = new Map<number, [number, number][]>();
    for (const point of points) {
        const column = Math.round(point[0]);
        const kept = columns.get(column) ?? [];
        kept.push(point);
        if (kept.length > 2) {
            kept.sort((a, b) => a[1] - b[1]);
            kept.splice(1, kept.length - 2);
            kept.sort((a, b) => a[0] - b[0]);
        }
        columns.set(column, kept);
    }
    return [...columns.values()].flat();
}

export function plot(data: PlotData, spans: [number, number][] = []): Plot {
    const x = scaleOf(
        data.series.flatMap((s) => s.x),
        data.x.log,
    );
    const y = scaleOf(
        data.series.flatMap((s) => s.y.filter((v): v is number => v !== null)),
        data.y.log,
    );
    const px = (v: number): number => LEFT + x.at(v) * (WIDTH - LEFT - RIGHT);
    const py = (v: number): number => HEIGHT - BOTTOM - y.at(v) * (HEIGHT - TOP - BOTTOM);
    const names = data.series.map((s) => s.name).join(", ");
    const root = svg("svg", {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        role: "img",
        "aria-label": `${data.title}: ${names}; ${data.y.label} over ${data.x.label}`,
    });
    for (const [from, to] of spans) {
        const left = px(Math.max(from, x.low));
        const width = Math.max(1, px(Math.min(to, x.high)) - left);
        root.append(svg("rect", { class: "span", x: left, y: TOP, width, height: HEIGHT - TOP - BOTTOM }));
    }
    axes(root, data.x, data.y, x, y, px, py);
    data.series.forEach((series, i) => {
        line(root, series, i, data, px, py);
    });
    const cursor = svg("line", { class: "cursor", y1: TOP, y2: HEIGHT - BOTTOM, visibility: "hidden" });
    const reader = svg("line", { class: "reader", y1: TOP, y2: HEIGHT - BOTTOM, visibility: "hidden" });
    root.append(cursor, reader);
    const readout = h("p", { class: "readout", "aria-live": "off" });
    const legend = h("ul", { class: "legend" }, ...data.series.map((s, i) => h("li", {}, key(i), s.name)));
    root.addEventListener("pointermove", (event) => read(event, root, data, px, reader, readout));
    root.addEventListener("pointerleave", () => {
        reader.setAttribute("visibility", "hidden");
        readout.textContent = "";
    });
    const element = h("figure", { class: "plot" }, h("figcaption", {}, data.title), legend, root, readout);
    return {
        element,
        setCursor(value) {
            const shown = value !== null && value >= x.low && value <= x.high;
            cursor.setAttribute("visibility", shown ? "visible" : "hidden");
            if (!shown) return;
            cursor.setAttribute("x1", String(px(value)));
            cursor.setAttribute("x2", String(px(value)));
        },
    };
}

function key(i: number): SVGElement {
    return svg(
        "svg",
        { viewBox: "0 0 26 10", class: "key", "aria-hidden": "true" },
        svg("line", { x1: 1, x2: 25, y1: 5, y2: 5, class: `series s${i % 6}`, "stroke-dasharray": DASHES[i % 6] }),
    );
}

function axes(
    root: SVGElement,
    xAxis: Axis,
    yAxis: Axis,
    x: Scale,
    y: Scale,
    px: (v: number) => number,
    py: (v: number) => number,
): void {
    const [right, bottom] = [WIDTH - RIGHT, HEIGHT - BOTTOM];
    for (const tick of y.ticks) {
        root.append(svg("line", { class: "grid", x1: LEFT, x2: right, y1: py(tick), y2: py(tick) }));
        root.append(
            svg("text", { class: "tick", x: LEFT - 5, y: py(tick) + 3.5, "text-anchor": "end" }, tickText(tick)),
        );
    }
    for (const tick of x.ticks) {
        root.append(svg("line", { class: "grid", x1: px(tick), x2: px(tick), y1: TOP, y2: bottom }));
        root.append(
            svg("text", { class: "tick", x: px(tick), y: bottom + 13, "text-anchor": "middle" }, tickText(tick)),
        );
    }
    root.append(
        svg("text", { class: "label", x: (LEFT + right) / 2, y: HEIGHT - 4, "text-anchor": "middle" }, xAxis.label),
    );
    const middle = (TOP + bottom) / 2;
    root.append(
        svg(
            "text",
            { class: "label", x: 11, y: middle, "text-anchor": "middle", transform: `rotate(-90 11 ${middle})` },
            yAxis.label,
        ),
    );
}

function line(
    root: SVGElement,
    series: Series,
    i: number,
    data: PlotData,
    px: (v: number) => number,
    py: (v: number) => number,
): void {
    const stretches: [number, number][][] = [[]];
    series.x.forEach((xv, k) => {
        const yv = series.y[k];
        const drawn =
            yv !== null &&
            yv !== undefined &&
            Number.isFinite(yv) &&
            (!data.y.log || yv > 0) &&
            (!data.x.log || xv > 0);
        if (drawn) stretches[stretches.length - 1].push([px(xv), py(yv)]);
        else if (stretches[stretches.length - 1].length > 0) stretches.push([]);
    });
    for (const stretch of stretches) {
        const points = thin(stretch);
        if (points.length === 0) continue;
        const d = points.map(([a, b], k) => `${k ? "L" : "M"}${a.toFixed(1)} ${b.toFixed(1)}`).join("");
        root.append(svg("path", { d, class: `series s${i % 6}`, "stroke-dasharray": DASHES[i % 6] }));
        if (points.length > 40) continue;
        for (const [a, b] of points) root.append(svg("circle", { cx: a, cy: b, r: 2.2, class: `point s${i % 6}` }));
    }
}

/** Shows the values of all series at the x nearest to the pointer. */
function read(
    event: PointerEvent,
    root: SVGSVGElement,
    data: PlotData,
    px: (v: number) => number,
    reader: SVGElement,
    readout: HTMLElement,
): void {
    const box = root.getBoundingClientRect();
    const at = ((event.clientX - box.left) / box.width) * WIDTH;
    let best: number | null = null;
    for (const series of data.series) {
        for (const value of series.x) {
            if (best === null || Math.abs(px(value) - at) < Math.abs(px(best) - at)) best = value;
        }
    }
    if (best === null) return;
    const shown = best;
    reader.setAttribute("visibility", "visible");
    reader.setAttribute("x1", String(px(shown)));
    reader.setAttribute("x2", String(px(shown)));
    const values = data.series.flatMap((s) => {
        const k = s.x.indexOf(shown);
        const value = k < 0 ? null : s.y[k];
        return value === null ? [] : [`${s.name} ${digits(value, 3)}`];
    });
    readout.textContent = `${data.x.label} ${digits(shown, 3)}: ${values.join(", ")}`;
}
