/** A slider for each mode, and motions along the mode. */

import { toFirstCollision, vibrate } from "./along";
import { type App, attempt } from "./app";
import { digits, h } from "./dom";
import { loadQ } from "./load-q";

interface Row {
    slider: HTMLInputElement;
    number: HTMLInputElement;
    vibrate: HTMLButtonElement;
}

export class ModesPanel {
    readonly element: HTMLElement;
    private readonly rows: Row[];
    private randoms = 0;

    constructor(private readonly app: App) {
        const { model } = app.shape;
        this.rows = Array.from({ length: model.rank }, (_, k) => this.row(k));
        const list = this.rows.map((row, k) => this.line(row, k));
        this.element = h(
            "div",
            { class: "modes" },
            h(
                "div",
                { class: "actions" },
                h(
                    "button",
                    {
                        type: "button",
                        onclick: () => this.reset(),
                        title: "reset q to the centre of the certificates (R)",
                    },
                    "Reset",
                ),
                h(
                    "button",
                    {
                        type: "button",
                        onclick: () => this.random(),
                        title: "show a random q (X)",
                    },
                    "Random",
                ),
                app.checker &&
                    h(
                        "button",
                        {
                            type: "button",
                            id: "random-collision",
                            onclick: () => this.randomCollision(),
                            title: "move along a random direction to the first self-collision (C)",
                        },
                        "To a collision",
                    ),
                h(
                    "button",
                    {
                        type: "button",
                        onclick: () => loadQ(app),
                        title: "paste numbers, or load a text or .npy file (L)",
                    },
                    "Load q…",
                ),
            ),
            h(
                "p",
                { class: "hint" },
                "Drag a slider; a double click resets it. ~ vibrates the mode",
                app.checker ? ", ⇥ moves along it to the first self-collision." : ".",
            ),
            h("div", { class: "mode-list" }, ...list),
        );
        app.pose.onChange(() => this.update());
        app.motion.onChange(() => this.update());
        this.update();
    }

    reset(): void {
        this.app.motion.stop();
        this.app.pose.show(this.app.shape.model.center);
    }

    random(): void {
        const { app } = this;
        app.motion.stop();
        const direction = this.direction();
        app.pose.show(direction.map((d, k) => app.shape.model.center[k] + d));
    }

    randomCollision(): void {
        const direction = this.direction();
        void attempt(this.app, () => toFirstCollision(this.app, direction, `random direction ${this.randoms}`));
    }

    vibrate(mode: number): void {
        vibrate(this.app, mode);
    }

    focus(mode: number): void {
        this.rows[mode]?.slider.focus();
    }

    /** The mode with the focus; null if none has it. */
    focused(): number | null {
        const at = this.rows.findIndex(
            (row) => row.slider === document.activeElement || row.number === document.activeElement,
        );
        return at < 0 ? null : at;
    }

    /** The next of a fixed sequence of random directions. Lower modes have larger entries, as in usual motions. */
    private direction(): number[] {
        let state = ++this.randoms * 0x9e3779b9;
        const uniform = (): number => {
            state = (state + 0x6d2b79f5) | 0;
            let t = Math.imul(state ^ (state >>> 15), 1 | state);
            t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
            return (((t ^ (t >>> 14)) >>> 0) + 0.5) / 4294967296;
        };
        const { limits } = this.app.shape.model;
        return limits.map((limit, k) => {
            const normal = Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
            return (limit * 0.25 * normal) / (1 + k / 2);
        });
    }

    private set(mode: number, value: number): void {
        if (!Number.isFinite(value)) return;
        this.app.motion.stop();
        this.app.pose.change(mode, value);
    }

    private row(k: number): Row {
        const { model } = this.app.shape;
        const limit = model.limits[k];
        const name = this.app.shape.modeName(k);
        const low = model.center[k] - limit;
        const high = model.center[k] + limit;
        const slider = h("input", {
            type: "range",
            min: low,
            max: high,
            step: limit / 500,
            "aria-label": `${name}, ${this.app.shape.frequency(k) || "weight"}`,
            oninput: () => this.set(k, slider.valueAsNumber),
            ondblclick: () => this.set(k, model.center[k]),
        });
        const number = h("input", {
            type: "number",
            step: "any",
            "aria-label": `${name}, exact value`,
            onchange: () => this.set(k, number.valueAsNumber),
        });
        const button = h(
            "button",
            {
                type: "button",
                class: "small",
                "aria-label": `vibrate ${name}`,
                title: "vibrate (V)",
                onclick: () => this.vibrate(k),
            },
            "~",
        );
        return { slider, number, vibrate: button };
    }

    private line({ slider, number, vibrate }: Row, k: number): HTMLElement {
        const { app } = this;
        const direction = (): number[] => app.shape.model.limits.map((_, i) => (i === k ? 1 : 0));
        const name = app.shape.modeName(k);
        return h(
            "div",
            { class: "mode" },
            h(
                "div",
                { class: "mode-name" },
                h("span", { title: name }, name),
                h("span", { class: "hertz" }, app.shape.frequency(k)),
            ),
            slider,
            number,
            vibrate,
            app.checker &&
                h(
                    "button",
                    {
                        type: "button",
                        class: "small",
                        "aria-label": `${name} to the first self-collision`,
                        title: "move to the first self-collision",
                        onclick: () =>
                            void attempt(app, () => toFirstCollision(app, this.toward(k, direction()), name)),
                    },
                    "⇥",
                ),
        );
    }

    /** The direction to the side of the centre on which the slider is. */
    private toward(k: number, direction: number[]): number[] {
        return this.app.pose.q[k] < this.app.shape.model.center[k] ? direction.map((d) => -d) : direction;
    }

    private update(): void {
        const { q } = this.app.pose;
        this.rows.forEach((row, k) => {
            row.slider.value = String(q[k]);
            if (document.activeElement !== row.number)
                row.number.value = q[k] === 0 ? "0" : digits(q[k]).replaceAll(",", "");
            row.vibrate.setAttribute(
                "aria-pressed",
                String(this.app.motion.name === `vibrating ${this.app.shape.modeName(k)}`),
            );
        });
    }
}
