/** The verdict on the displayed q, and |z| as a share of the root's radius. */
import type { App } from "./app";
import { count, digits, h } from "./dom";

type Kind = "root" | "free" | "colliding" | "checking" | "unknown";

interface Verdict {
    kind: Kind;
    text: string;
}

/** The sentences of reports of earlier versions, which do not say what was left out. */
const EARLIER = { root: "free: proven by the root's certificate", tests: "free: proven" };

/** The verdict on the displayed q. An answer counts only for its own q. */
export function verdict(app: App): Verdict {
    const { checker, pose, recorded } = app;
    if (recorded) {
        const { pairs } = recorded;
        if (recorded.isEnd) return { kind: "unknown", text: "the last frame: no step follows" };
        if (pairs === null) return { kind: "unknown", text: "unknown: collisions of this frame were not recorded" };
        const { impact } = recorded;
        const step = impact === undefined ? "" : " until the next frame";
        const first = typeof impact === "number" ? `, first at ${impact.toFixed(4)} of the step` : "";
        if (pairs > 0)
            return { kind: "colliding", text: `COLLIDING ${count(pairs, "pair")}${step}${first} (as recorded)` };
        return { kind: "free", text: `free${step} (as recorded)${recorded.apart}` };
    }
    const { root, tests } = app.shape.model.free ?? EARLIER;
    // This is decided in the frame that draws the shape. The answer agrees, and adds the cost of the query.
    if (app.shape.isRootCertified(pose.q)) return { kind: "root", text: root };
    if (!checker) return { kind: "unknown", text: "not checked: this is a report" };
    if (checker.error) return { kind: "unknown", text: "unknown: no answer" };
    const answer = checker.answer;
    if (!answer || answer.serial !== pose.serial) return { kind: "checking", text: "checking…" };
    if (answer.colliding) {
        const pairs = `${answer.complete ? "" : "at least "}${count(answer.count, "pair")}`;
        return { kind: "colliding", text: `COLLIDING ${pairs}` };
    }
    if (answer.root_certified) return { kind: "root", text: root };
    return { kind: "free", text: tests };
}

/** The largest number of pairs in one step between the previous frame and this one, as text. */
export function sinceText(since: number): string {
    return since > 0 ? `collided between frames: at most ${count(since, "pair")} in one step` : "";
}

/** The ratio of |z| to the root's radius: in percent below twice the radius, else as a multiple. */
function shareText(share: number): string {
    if (share < 2) return `${(100 * share).toFixed(1)}%`;
    if (!Number.isFinite(share)) return "beyond any multiple";
    return share < 1e9
        ? `${share.toLocaleString("en", { maximumFractionDigits: share < 100 ? 1 : 0 })} times`
        : `${share.toExponential(1)} times`;
}

export class Gauge {
    readonly element: HTMLElement;
    private readonly mark = h("span", { class: "verdict-mark", "aria-hidden": "true" });
    private readonly text = h("span", { class: "verdict-text" });
    private readonly since = h("div", { class: "since", role: "status", "aria-live": "polite", hidden: true });
    private readonly needle = h("div", { class: "needle" });
    private readonly bar = h("div", { class: "bar" }, h("div", { class: "root-tick" }), this.needle);
    private readonly detail = h("div", { class: "detail" });
    private shown = "";

    constructor(private readonly app: App) {
        this.element = h(
            "section",
            { class: "gauge", "aria-label": "certificate gauge" },
            h(
                "div",
                { class: "verdicts" },
                h("div", { class: "verdict", role: "status", "aria-live": "polite" }, this.mark, this.text),
                this.since,
            ),
            this.bar,
            this.detail,
        );
    }

    /** Updates the gauge in the frame that draws the same q. */
    update(): void {
        const { app } = this;
        const { kind, text } = verdict(app);
        const answer = app.checker?.answer;
        const answered = answer && answer.serial === app.pose.serial ? answer : null;
        const norm = app.recorded && !app.body ? null : (answered?.norm ?? app.shape.norm(app.pose.q));
        const root = app.shape.model.root_radius;
        const share = norm === null || root === null ? null : norm / root;
        this.element.dataset.serial = String(app.pose.serial);
        const since = sinceText(app.recorded?.since ?? 0);
        const key = `${kind} ${text} ${since} ${norm} ${answered?.microseconds}`;
        if (key === this.shown) return;
        this.shown = key;
        this.element.dataset.kind = kind;
        this.mark.textContent = { root: "●", free: "●", colliding: "▲", checking: "…", unknown: "?" }[kind];
        this.text.textContent = text;
        this.since.textContent = since;
        this.since.hidden = since === "";
        this.bar.hidden = norm === null;
        // The root's radius is at half of the bar; larger norms share the other half.
        const at = share === null ? 0 : share <= 1 ? share / 2 : 1 - 0.5 / share;
        this.needle.style.width = `${(100 * at).toFixed(2)}%`;
        const of = root === null ? "root radius infinite" : `root radius ${digits(root)}`;
        const ratio = share === null ? "" : ` · ${shareText(share)}`;
        this.detail.textContent = norm === null ? "" : `|z| ${digits(norm)} · ${of}${ratio}`;
    }
}
