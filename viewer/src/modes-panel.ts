/** The sliders of all modes, with a filter by name, and motions along the modes. */

import { toFirstCollision, vibrate, vibrationName } from "./along";
import { type App, attempt } from "./app";
import { count, h } from "./dom";
import { intervalSearch, showMarks } from "./intervals";
import { loadQ } from "./load-q";
import { ModeRow } from "./mode-row";
import { randomDirection } from "./random-direction";
import { Sweeps } from "./sweeps";

export class ModesPanel {
    readonly element: HTMLElement;
    private readonly rows: ModeRow[];
    private readonly list: HTMLElement;
    /** The displayed weights. */
    private shown: Float64Array;
    private vibrating: string | null = null;
    private readonly sweeps: Sweeps | null;
    private readonly filter: HTMLInputElement;
    private readonly found = h("output", { class: "found" });
    private readonly names: string[];
    private randoms = 0;

    constructor(private readonly app: App) {
        const { shape, pose } = app;
        const actions = {
            set: (mode: number, value: number) => this.set(mode, value),
            vibrate: (mode: number) => this.vibrate(mode),
            toCollision: app.source.live ? (mode: number) => this.toCollision(mode) : null,
        };
        this.rows = Array.from({ length: shape.model.rank }, (_, k) => new ModeRow(shape, k, actions));
        this.names = this.rows.map((_, k) => shape.modeName(k).toLowerCase());
        this.shown = new Float64Array(shape.model.rank).fill(Number.NaN);
        this.list = h("div", { class: "mode-list" }, ...this.rows.map((row) => row.element));
        this.sweeps = app.source.live
            ? new Sweeps(
                  app,
                  this.rows,
                  () => this.named(),
                  () => this.refilter(),
              )
            : null;
        this.filter = h("input", {
            type: "search",
            placeholder: "filter by name",
            "aria-label": "filter by name",
            title: "show only modes whose names have all of these words (/)",
            oninput: () => this.refilter(),
        });
        const marks = app.source.live ? intervalSearch(app, this.rows, () => this.named()) : null;
        if (shape.model.intervals)
            showMarks(app, this.rows, shape.model.intervals, Float64Array.from(shape.model.default_q));
        this.element = h(
            "div",
            { class: "modes" },
            this.actions(),
            h(
                "p",
                { class: "hint" },
                "Drag a slider, or type any weight; a double click resets it. ~ vibrates the mode",
                app.source.live ? ", ⇥ moves along it to the first self-collision." : ".",
            ),
            h("div", { class: "find" }, this.filter, this.found, this.sweeps?.element ?? null, marks),
            this.list,
        );
        pose.onChange(() => this.update());
        app.motion.onChange(() => this.updateVibrating());
        this.update();
        this.refilter();
    }

    reset(): void {
        this.app.takeOver();
        this.app.pose.show(this.app.shape.model.center);
    }

    random(): void {
        const { app } = this;
        app.takeOver();
        const direction = randomDirection(app.shape, ++this.randoms);
        app.pose.show(direction.map((d, k) => app.shape.model.center[k] + d));
    }

    randomCollision(): void {
        const direction = randomDirection(this.app.shape, ++this.randoms);
        void attempt(this.app, () => toFirstCollision(this.app, direction, `random direction ${this.randoms}`));
    }

    vibrate(mode: number): void {
        vibrate(this.app, mode);
    }

    /** Moves the focus to the next or previous slider that the filter shows. */
    step(by: number): void {
        const visible = this.visible();
        const focused = this.focused();
        const at = focused === null ? -1 : visible.indexOf(focused);
        const to = at < 0 ? 0 : Math.min(Math.max(at + by, 0), visible.length - 1);
        this.rows[visible[to]]?.slider.focus();
    }

    /** Moves the focus to the filter. */
    find(): void {
        this.filter.focus();
        this.filter.select();
    }

    /** The mode with the focus; null if none has it. */
    focused(): number | null {
        const at = this.rows.findIndex((row) => row.hasFocus);
        return at < 0 ? null : at;
    }

    /** The modes whose names have all words of the filter. */
    private named(): number[] {
        const words = this.filter.value.toLowerCase().split(/\s+/);
        return [...this.names.keys()].filter((k) => words.every((word) => this.names[k].includes(word)));
    }

    /** The displayed modes. */
    private visible(): number[] {
        return [...this.rows.keys()].filter((k) => !this.rows[k].element.hidden);
    }

    private refilter(): void {
        const { sweeps } = this;
        const visible = new Set(this.named().filter((k) => !sweeps?.onlyHits.checked || sweeps.hasHit(k)));
        for (const [k, { element }] of this.rows.entries())
            if (element.hidden === visible.has(k)) element.hidden = !visible.has(k);
        const shown = visible.size;
        const { length } = this.rows;
        this.found.textContent =
            shown === length ? count(length, "mode") : `${shown.toLocaleString("en")} of ${count(length, "mode")}`;
    }

    private set(mode: number, value: number): void {
        this.app.takeOver();
        this.app.pose.change(mode, value);
    }

    /** Moves from the centre along a mode, to the side on which its slider is. */
    private toCollision(mode: number): void {
        const { app } = this;
        const { center } = app.shape.model;
        const sign = app.pose.q[mode] < center[mode] ? -1 : 1;
        const direction = center.map((_, k) => (k === mode ? sign : 0));
        void attempt(app, () => toFirstCollision(app, direction, app.shape.modeName(mode)));
    }

    /** Updates the rows whose weights have changed. */
    private update(): void {
        const { q } = this.app.pose;
        for (const [k, row] of this.rows.entries()) if (q[k] !== this.shown[k]) row.show(q[k]);
        this.shown = q.slice();
    }

    private updateVibrating(): void {
        const { name } = this.app.motion;
        if (name === this.vibrating) return;
        this.vibrating = name;
        for (const [k, row] of this.rows.entries()) row.showVibrating(name === vibrationName(this.app, k));
    }

    private actions(): HTMLElement {
        const { app } = this;
        const button = (text: string, title: string, onclick: () => void): HTMLElement =>
            h("button", { type: "button", title, onclick }, text);
        return h(
            "div",
            { class: "actions" },
            button("Reset", "reset q to the centre of the certificates (R)", () => this.reset()),
            button("Random", "show a random q (X)", () => this.random()),
            app.source.live &&
                button("To a collision", "move along a random direction to the first self-collision (C)", () =>
                    this.randomCollision(),
                ),
            button("Load q…", "paste numbers, or load a text or .npy file (L)", () => loadQ(app)),
        );
    }
}
