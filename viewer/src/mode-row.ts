/** The row of one mode: its whole name, its slider, its exact weight, and its first collisions. */
import { digits, h } from "./dom";
import type { Shape } from "./shape";

/** Steps of a slider over its range. */
const STEPS = 1000;

export interface RowActions {
    set(mode: number, value: number): void;
    vibrate(mode: number): void;
    /** Null in a report. */
    toCollision: ((mode: number) => void) | null;
}

export class ModeRow {
    readonly element: HTMLElement;
    readonly slider: HTMLInputElement;
    readonly number: HTMLInputElement;
    /** The column of first collisions: see sweeps.ts. */
    readonly first = h("span", { class: "first" });
    /** The marks of collisions along the slider: see intervals.ts. */
    readonly marks = h("span", { class: "marks" });
    private readonly vibrating: HTMLButtonElement;
    private readonly range: readonly [number, number];
    private weight = 0;

    constructor(shape: Shape, mode: number, actions: RowActions) {
        const name = shape.modeName(mode);
        const hertz = shape.frequency(mode);
        const [low, high] = shape.range(mode);
        this.range = [low, high];
        this.slider = h("input", {
            type: "range",
            min: low,
            max: high,
            step: (high - low) / STEPS,
            "aria-label": `${name}, ${hertz || "weight"}`,
            oninput: () => actions.set(mode, this.slider.valueAsNumber),
            ondblclick: () => actions.set(mode, shape.model.center[mode]),
        });
        this.number = h("input", {
            type: "number",
            step: "any",
            "aria-label": `${name}, exact value`,
            onchange: () => {
                const { valueAsNumber } = this.number;
                if (Number.isFinite(valueAsNumber)) actions.set(mode, valueAsNumber);
                else this.showNumber();
            },
        });
        this.vibrating = h(
            "button",
            {
                type: "button",
                class: "small",
                "aria-label": `vibrate ${name}`,
                title: "vibrate (V)",
                onclick: () => actions.vibrate(mode),
            },
            "~",
        );
        const { toCollision } = actions;
        this.element = h(
            "div",
            { class: "mode" },
            h(
                "div",
                { class: "mode-head" },
                h("span", { class: "mode-name" }, name),
                hertz !== "" && h("span", { class: "hertz" }, hertz),
                this.first,
            ),
            h(
                "div",
                { class: "mode-controls" },
                h("span", { class: "slide" }, this.slider, this.marks),
                this.number,
                this.vibrating,
                toCollision &&
                    h(
                        "button",
                        {
                            type: "button",
                            class: "small",
                            "aria-label": `${name} to the first self-collision`,
                            title: "move to the first self-collision",
                            onclick: () => toCollision(mode),
                        },
                        "⇥",
                    ),
            ),
        );
    }

    /** Whether the slider or the number has the focus. */
    get hasFocus(): boolean {
        const { activeElement } = document;
        return activeElement === this.slider || activeElement === this.number;
    }

    /** Shows a weight. Beyond the range the slider stays at its end; the number is exact. */
    show(weight: number): void {
        this.weight = weight;
        this.slider.value = String(weight);
        if (document.activeElement !== this.number) this.showNumber();
        const isBeyond = weight < this.range[0] || weight > this.range[1];
        if (isBeyond === this.element.classList.contains("beyond")) return;
        this.element.classList.toggle("beyond", isBeyond);
        const note = "beyond the range of the slider";
        this.number.title = isBeyond ? note : "";
        if (isBeyond) this.slider.setAttribute("aria-valuetext", note);
        else this.slider.removeAttribute("aria-valuetext");
    }

    private showNumber(): void {
        this.number.value = this.weight === 0 ? "0" : digits(this.weight).replaceAll(",", "");
    }

    showVibrating(isVibrating: boolean): void {
        this.vibrating.setAttribute("aria-pressed", String(isVibrating));
    }
}
