/**
 * The column of first collisions: for each mode the first weights, above and below its own, at which the shape touches itself,
 * the other weights being those displayed when the search began. The server searches mode by mode.
 */
import { type App, attempt } from "./app";
import { digits, h } from "./dom";
import type { ModeRow } from "./mode-row";
import type { Sweep } from "./protocol";
import { RequestError } from "./source";

export class Sweeps {
    readonly onlyHits = h("input", { type: "checkbox", "aria-label": "only modes that collide" });
    private readonly button = h("button", { type: "button", onclick: () => this.toggle() });
    private readonly state = h("p", { class: "hint", role: "status", hidden: true });
    private readonly only = h("label", { class: "check", hidden: true }, this.onlyHits, "only those that collide");
    readonly element = h("div", { class: "sweeps" }, this.button, this.only, this.state);
    /** The q of all results. */
    private base: Float64Array;
    private readonly results = new Map<number, Sweep[]>();
    private running: AbortController | null = null;

    constructor(
        private readonly app: App,
        private readonly rows: ModeRow[],
        private readonly list: HTMLElement,
        /** The modes to search. */
        private readonly listed: () => number[],
        /** Called when `hasHit` has changed. */
        private readonly changed: () => void,
    ) {
        this.onlyHits.addEventListener("change", changed);
        this.base = app.pose.q.slice();
        app.pose.onChange(() => this.compare());
        this.showState("");
    }

    /** Whether a collision of the mode is known. */
    hasHit(mode: number): boolean {
        return this.results.get(mode)?.some((sweep) => sweep.first_hit !== null) ?? false;
    }

    private toggle(): void {
        if (this.running) this.running.abort();
        else void attempt(this.app, () => this.run());
    }

    private async run(): Promise<void> {
        const { app } = this;
        app.motion.stop();
        const answer = app.checker?.answer;
        if (answer?.serial === app.pose.serial && answer.colliding)
            throw new Error(
                "the displayed shape collides already: begin at a free one; sscc view --ignore-rest leaves out pairs at rest",
            );
        if (app.pose.q.some((weight, k) => weight !== this.base[k])) this.clear();
        this.base = app.pose.q.slice();
        this.compare();
        const modes = this.listed().filter((mode) => !this.results.has(mode));
        const running = new AbortController();
        this.running = running;
        this.only.hidden = false;
        let done = 0;
        try {
            for (const mode of modes) {
                this.showState(`${done} of ${modes.length} modes searched`);
                this.rows[mode].first.textContent = "…";
                await this.ask(mode, running.signal);
                done++;
            }
            this.showState("");
        } catch (error) {
            if (!running.signal.aborted) throw error;
        } finally {
            for (const mode of modes) if (!this.results.has(mode)) this.rows[mode].first.replaceChildren();
            this.running = null;
            this.showState(done < modes.length ? `stopped after ${done} of ${modes.length} modes` : "");
        }
    }

    private async ask(mode: number, signal: AbortSignal): Promise<void> {
        const range = this.app.shape.range(mode);
        const request = { q: [...this.base], mode, range };
        let cells: (Node | string)[];
        try {
            const found = await this.app.source.ask<Sweep[]>("/api/sweep", request, signal);
            this.results.set(mode, found);
            cells = found.map((sweep) => this.cell(mode, sweep));
        } catch (error) {
            // A search that takes too long has no result; the others may have one.
            if (!(error instanceof RequestError) || !error.message.includes("no result within")) throw error;
            this.results.set(mode, []);
            cells = [h("span", { title: error.message }, "no result")];
        }
        this.rows[mode].first.replaceChildren(...cells);
        this.changed();
    }

    private cell(mode: number, sweep: Sweep): HTMLElement {
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
            const q = this.base.slice();
            q[mode] = hit;
            this.app.motion.stop();
            this.app.pose.show(q);
        };
        return h(
            "button",
            { type: "button", class: "small hit", title, "aria-label": label, onclick: show },
            `${arrow} ${text}`,
        );
    }

    private clear(): void {
        this.results.clear();
        for (const row of this.rows) row.first.replaceChildren();
        this.changed();
    }

    /** Results hold where all weights but that of their mode are those of the search. Others are shown pale. */
    private compare(): void {
        const { q } = this.app.pose;
        let [changed, last] = [0, -1];
        for (let k = 0; k < q.length; k++) {
            if (q[k] === this.base[k]) continue;
            changed++;
            last = k;
        }
        this.list.classList.toggle("stale", changed > 0);
        this.list.querySelector(".mode.current")?.classList.remove("current");
        if (changed === 1) this.rows[last].element.classList.add("current");
        const isStale = changed > 0 && this.results.size > 0;
        if (!this.running) this.showState(isStale ? "pale: found with other weights than those displayed" : "");
    }

    private showState(text: string): void {
        this.button.textContent = this.running ? "Stop" : "Find first collisions";
        this.button.title = this.running
            ? "stop the search"
            : "find the first colliding weight of each listed mode, with the other weights as displayed";
        this.state.textContent = text;
        this.state.hidden = text === "";
    }
}
