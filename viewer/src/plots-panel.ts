/** The panel of plots. */
import type { App } from "./app";
import { h } from "./dom";
import { type Plot, plot } from "./plot";
import type { Model, PlotData } from "./protocol";

/** The radii of the certificates per level of the hierarchy (the paper's Figure 7). */
function levels(model: Model): PlotData {
    const x = model.levels.map((l) => l.level);
    const root = model.root_radius;
    const names = { least: "minimum", median: "median", largest: "maximum" };
    const series = (["least", "median", "largest"] as const).map((key) => ({
        name: names[key],
        x,
        y: model.levels.map((l) => l[key]),
    }));
    if (root !== null) series.push({ name: "root", x, y: x.map(() => root) });
    return {
        title: `Radius of certificates per level: ${model.name}`,
        x: { label: "level of the hierarchy", log: false },
        y: { label: `radius (${model.metric})`, log: true },
        series,
    };
}

/** Times of self-collisions, as spans of frames: in a frame, or in a step before the next frame. */
export function contactSpans(times: number[], pairs: number[][], since: number[] | null): [number, number][] {
    const spans: [number, number][] = [];
    let open: number | null = null;
    times.forEach((time, i) => {
        const touching = pairs.some((p) => p[i] > 0) || (since?.[i + 1] ?? 0) > 0;
        if (touching && open === null) open = time;
        const end = !touching || i === times.length - 1;
        if (end && open !== null) {
            spans.push([open, time]);
            open = null;
        }
    });
    return spans;
}

export class PlotsPanel {
    readonly element = h("div", { class: "plots" });
    private readonly timed: Plot[] = [];

    constructor(app: App) {
        const { scene } = app;
        const pairs = scene.playback?.bodies.flatMap((b) => (b.pairs ? [b.pairs] : [])) ?? [];
        const spans = contactSpans(scene.playback?.times ?? [], pairs, scene.playback?.pairs_since ?? null);
        const contacts = scene.playback?.contacts;
        const noun = contacts?.is_between || contacts?.seconds ? "contact" : "self-contact";
        const overTime = scene.playback?.costs ?? null;
        const all = [
            ...(overTime ? [overTime] : []),
            ...scene.plots,
            ...scene.models.filter((m) => m.levels.length > 1).map(levels),
        ];
        for (const data of all) {
            const timed = data === overTime || (/time|\(s\)/.test(data.x.label) && scene.playback !== null);
            const made = plot(data, timed ? spans : []);
            if (timed) this.timed.push(made);
            this.element.append(made.element);
        }
        if (all.length === 0) this.element.append(h("p", { class: "hint" }, "There is nothing to plot."));
        if (spans.length > 0)
            this.element.prepend(
                h("p", { class: "hint" }, h("span", { class: "span-key", "aria-hidden": "true" }), noun),
            );
    }

    setTime(time: number | null): void {
        for (const plot of this.timed) plot.setCursor(time);
    }
}
