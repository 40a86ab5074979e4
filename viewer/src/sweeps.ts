/** First collisions: for each mode the first weights, above and below its own, at which the shape touches itself. */
import type { App } from "./app";
import { digits, h } from "./dom";
import type { ModeRow } from "./mode-row";
import { ModeSearch } from "./mode-search";
import type { Sweep } from "./protocol";

export class Sweeps {
    readonly onlyHits = h("input", { type: "checkbox", "aria-label": "only modes that collide" });
    private readonly only = h("label", { class: "check", hidden: true }, this.onlyHits, "only those that collide");
    private readonly search: ModeSearch<Sweep[]>;
    readonly element: HTMLElement;

    constructor(
        private readonly app: App,
        rows: ModeRow[],
        listed: () => number[],
        /** Called when `hasHit` has changed. */
        changed: () => void,
    ) {
        this.onlyHits.addEventListener("change", changed);
        this.search = new ModeSearch(
            app,
            rows,
            listed,
            {
                path: "/api/sweep",
                label: "Find first collisions",
                title: "find the first colliding weight of each listed mode, with the other weights as displayed",
                done: "searched",
                cell: (row) => row.first,
                show: (mode, sweeps, base) => sweeps.map((sweep) => this.cell(mode, sweep, base)),
                check: () => this.check(),
            },
            changed,
        );
        this.element = h("div", { class: "sweeps" }, this.search.button, this.only, this.search.state);
    }

    /** Whether a collision of the mode is known. */
    hasHit(mode: number): boolean {
        return this.search.results.get(mode)?.some((sweep) => sweep.first_hit !== null) ?? false;
    }

    private check(): void {
        const { app } = this;
        const answer = app.checker?.answer;
        if (answer?.serial === app.pose.serial && answer.colliding)
            throw new Error(
                "the displayed shape collides already: begin at a free one; sscc view --ignore-rest leaves out pairs at rest",
            );
        this.only.hidden = false;
    }

    private cell(mode: number, sweep: Sweep, base: Float64Array): HTMLElement {
        const { from, to, first_free: free, first_hit: hit, note } = sweep;
        const arrow = to > from ? "↑" : "↓";
        const name = this.app.shape.modeName(mode);
        const proven = free === null ? "" : `proven free from ${from} to ${free}`;
        const pairs = sweep.pairs[0]
            ? `${sweep.count.toLocaleString("en")} pairs, first ${sweep.pairs[0].join(" – ")}`
            : "";
        const touches = hit === null ? "" : `touches at ${hit}: ${pairs}`;
        const title = [proven, touches, note].filter((part) => part).join("; ");
        if (hit === null) {
            const text = note === null ? "free" : `free to ${digits(free)}, then unknown`;
            return h("span", { class: "free", title }, `${arrow} ${text}`);
        }
        const text = free === null ? "at once" : `${digits(hit)}${note === null ? "" : " *"}`;
        const label = `${name} touches at ${digits(hit)}; show it`;
        const show = (): void => {
            this.app.takeOver();
            const q = base.slice();
            q[mode] = hit;
            this.app.pose.show(q);
        };
        return h(
            "button",
            { type: "button", class: "small hit", title, "aria-label": label, onclick: show },
            `${arrow} ${text}`,
        );
    }
}
