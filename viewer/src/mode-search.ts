/**
 * A search over modes: its button, its state, and its results. It sends one request for each mode; the other weights are those
 * that were displayed when it began. Rows show the results, pale while other weights are displayed.
 */
import { type App, attempt } from "./app";
import { h } from "./dom";
import type { ModeRow } from "./mode-row";
import { RequestError } from "./source";

/** The request of a search, and how its results are shown. */
export interface SearchKind<T> {
    /** The path of the request. */
    path: string;
    label: string;
    title: string;
    /** The word after the number of finished modes, such as "searched". */
    done: string;
    /** The element in which a row shows the result. */
    cell(row: ModeRow): HTMLElement;
    /** The content of that element. */
    show(mode: number, result: T, base: Float64Array): (Node | string)[];
    /** Throws an error if the search cannot begin. */
    check(): void;
}

/**
 * Makes results pale that were found with other weights than those displayed; the weight of a result's own mode may differ.
 * Returns whether any result is pale.
 */
export function fade(
    app: App,
    base: Float64Array,
    modes: Iterable<number>,
    cell: (mode: number) => HTMLElement,
): boolean {
    const { q } = app.pose;
    let [changed, last] = [0, -1];
    for (let k = 0; k < q.length; k++) {
        if (q[k] === base[k]) continue;
        changed++;
        last = k;
    }
    let isStale = false;
    for (const mode of modes) {
        const isPale = changed > 1 || (changed === 1 && last !== mode);
        cell(mode).classList.toggle("stale", isPale);
        isStale ||= isPale;
    }
    return isStale;
}

export class ModeSearch<T> {
    readonly button = h("button", { type: "button", onclick: () => this.toggle() });
    readonly state = h("p", { class: "hint", role: "status", hidden: true });
    readonly results = new Map<number, T | null>();
    /** The q of all results. */
    private base: Float64Array;
    private running: AbortController | null = null;

    constructor(
        private readonly app: App,
        private readonly rows: ModeRow[],
        /** The modes to search. */
        private readonly listed: () => number[],
        private readonly kind: SearchKind<T>,
        /** Called when results have changed. */
        private readonly changed: () => void,
    ) {
        this.base = app.pose.q.slice();
        app.pose.onChange(() => this.compare());
        this.showState("");
    }

    private toggle(): void {
        if (this.running) this.running.abort();
        else void attempt(this.app, () => this.run());
    }

    private async run(): Promise<void> {
        const { app, kind } = this;
        app.takeOver();
        kind.check();
        if (app.pose.q.some((weight, k) => weight !== this.base[k])) this.clear();
        this.base = app.pose.q.slice();
        this.compare();
        // Modes whose search took too long are searched again.
        const modes = this.listed().filter((mode) => !this.results.get(mode));
        for (const mode of modes) this.results.delete(mode);
        const running = new AbortController();
        this.running = running;
        let done = 0;
        try {
            for (const mode of modes) {
                this.showState(`${done} of ${modes.length} modes ${kind.done}`);
                kind.cell(this.rows[mode]).textContent = "…";
                await this.ask(mode, running.signal);
                done++;
            }
        } catch (error) {
            if (!running.signal.aborted) throw error;
        } finally {
            for (const mode of modes) if (!this.results.has(mode)) kind.cell(this.rows[mode]).replaceChildren();
            this.running = null;
            if (done < modes.length) this.showState(`stopped after ${done} of ${modes.length} modes`);
            else this.compare();
        }
    }

    private async ask(mode: number, signal: AbortSignal): Promise<void> {
        const { app, kind } = this;
        const request = { q: [...this.base], mode, range: app.shape.range(mode) };
        let content: (Node | string)[];
        try {
            const found = await app.source.ask<T>(kind.path, request, signal);
            this.results.set(mode, found);
            content = kind.show(mode, found, this.base);
        } catch (error) {
            // A search that takes too long has no result; the others may have one.
            if (!(error instanceof RequestError) || !error.message.includes("no result within")) throw error;
            this.results.set(mode, null);
            content = [h("span", { title: error.message }, "no result")];
        }
        kind.cell(this.rows[mode]).replaceChildren(...content);
        this.compare();
        this.changed();
    }

    private clear(): void {
        this.results.clear();
        for (const row of this.rows) {
            this.kind.cell(row).replaceChildren();
            this.kind.cell(row).classList.remove("stale");
        }
        this.changed();
    }

    /** Makes the results pale that do not hold: a result holds if all weights but that of its mode are those of the search. */
    private compare(): void {
        const modes = this.results.keys();
        const isStale = fade(this.app, this.base, modes, (mode) => this.kind.cell(this.rows[mode]));
        if (!this.running) this.showState(isStale ? "pale: found with other weights than those displayed" : "");
    }

    private showState(text: string): void {
        this.button.textContent = this.running ? "Stop" : this.kind.label;
        this.button.title = this.running ? "stop the search" : this.kind.title;
        this.state.textContent = text;
        this.state.hidden = text === "";
    }
}
