/** The colliding pairs of the displayed q, and the cost of the query compared with the traditional method. */
import { type App, attempt } from "./app";
import { count, digits, duration, h } from "./dom";
import type { Answer, Traditional } from "./protocol";

const FIRST_ROWS = 100;
/** The traditional method runs after q has not changed for this time (ms). */
const REST_TIME = 350;

/** The number of pairs; a limited search knows only a lower bound. */
function pairsText({ count, complete }: Answer | Traditional): string {
    return `${complete ? "" : "at least "}${count.toLocaleString("en")}`;
}

export class CollisionsPanel {
    readonly element: HTMLElement;
    private readonly counters = h("table", { class: "counters" });
    private readonly list = h("ol", { class: "pairs" });
    private readonly heading = h("h2", {}, "Pairs");
    private readonly compare = h("input", {
        type: "checkbox",
        id: "compare",
        checked: true,
        onchange: () => this.changed(),
    });
    private traditional: { serial: number; answer: Traditional } | null = null;
    private rows = FIRST_ROWS;
    private timer = 0;
    private at = -1;

    constructor(private readonly app: App) {
        // Only the server has this method.
        if (!app.source.live) this.compare.checked = false;
        this.element = h(
            "div",
            { class: "collisions" },
            h("h2", {}, "Cost of this query"),
            this.counters,
            app.source.live && h("label", { class: "check" }, this.compare, "also measure the traditional method"),
            this.heading,
            h("p", { class: "hint" }, "N flies to the next pair, H shows what is cut away in front of it."),
            this.list,
        );
        app.checker!.onAnswer(() => this.answered());
        app.pose.onChange(() => this.changed());
        this.answered();
    }

    /** Flies to the pair `step` rows further in the list. */
    next(step: number): void {
        const pairs = this.current()?.pairs ?? [];
        if (pairs.length === 0) return;
        this.go((this.at + step + pairs.length) % pairs.length);
    }

    private current(): Answer | null {
        const { answer } = this.app.checker!;
        return answer && answer.serial === this.app.pose.serial ? answer : null;
    }

    private changed(): void {
        this.app.chosen = null;
        this.app.stage?.endCut();
        this.at = -1;
        this.rows = FIRST_ROWS;
        clearTimeout(this.timer);
        if (this.compare.checked)
            this.timer = window.setTimeout(() => void attempt(this.app, () => this.ask()), REST_TIME);
        this.answered();
    }

    private async ask(): Promise<void> {
        const { pose } = this.app;
        const serial = pose.serial;
        const answer = await this.app.source.ask<Traditional>("/api/traditional", { q: [...pose.q] });
        this.traditional = { serial, answer };
        this.answered();
    }

    private go(at: number): void {
        const { app } = this;
        const pair = this.current()?.pairs[at];
        if (!pair) return;
        this.at = at;
        app.chosen = pair;
        const { shape, pose } = app;
        const surface = { positions: shape.deformed(pose.q), faces: shape.faces, own: pair };
        app.stage?.flyTo(
            pair.map((t) => shape.corners(t, pose.q)),
            [surface],
        );
        app.refreshMarks();
        this.showPairs(this.current());
    }

    private answered(): void {
        const answer = this.current();
        const traditional = this.traditional?.serial === this.app.pose.serial ? this.traditional.answer : null;
        const { live } = this.app.source;
        const cells = (name: string, a: string, b = ""): HTMLElement =>
            h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, a), h("td", {}, b));
        const number = (value: number | undefined): string =>
            value === undefined ? "…" : value.toLocaleString("en");
        const ratio = answer && traditional ? traditional.microseconds / answer.microseconds : null;
        this.counters.replaceChildren(
            h(
                "tr",
                {},
                h("td", {}),
                h("th", { scope: "col" }, "sscc"),
                live && h("th", { scope: "col" }, "traditional"),
            ),
            cells(
                "time",
                answer ? duration(answer.microseconds) : "…",
                traditional ? duration(traditional.microseconds) : this.compare.checked ? "…" : "",
            ),
            cells("pairs", answer ? pairsText(answer) : "…", traditional ? pairsText(traditional) : ""),
            cells("nodes opened", number(answer?.opened)),
            cells("AABB tests", number(answer?.box_tests)),
            cells("triangle tests", number(answer?.triangle_tests)),
            ...(live ? [cells("speed-up", ratio ? `${digits(ratio, ratio < 100 ? 2 : 3)} ×` : "")] : []),
        );
        this.showPairs(answer);
    }

    private showPairs(answer: Answer | null): void {
        this.heading.textContent = answer
            ? answer.count
                ? `${answer.complete ? "" : "At least "}${count(answer.count, "colliding pair")}`
                : "No pair collides"
            : "Pairs";
        const pairs = answer?.pairs ?? [];
        const rows: HTMLElement[] = pairs.slice(0, this.rows).map((pair, i) => {
            const chosen = this.app.chosen?.[0] === pair[0] && this.app.chosen[1] === pair[1];
            return h(
                "li",
                {},
                h(
                    "button",
                    { type: "button", class: "pair", "aria-pressed": String(chosen), onclick: () => this.go(i) },
                    `${pair[0]} – ${pair[1]}`,
                ),
            );
        });
        const hidden = pairs.length - rows.length;
        if (hidden > 0) {
            const more = (): void => {
                this.rows += 1000;
                this.showPairs(this.current());
            };
            rows.push(
                h("li", {}, h("button", { type: "button", onclick: more }, `${hidden.toLocaleString("en")} more`)),
            );
        }
        if (answer && answer.count > pairs.length)
            rows.push(
                h(
                    "li",
                    { class: "hint" },
                    `the first ${pairs.length.toLocaleString("en")} of ${pairsText(answer)} pairs are listed`,
                ),
            );
        this.list.replaceChildren(...rows);
    }
}
