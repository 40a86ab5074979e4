/** Certificates on the shape: nodes coloured by radius, or as opened and culled by the query; AABBs of nodes. */
import { type App, attempt } from "./app";
import { digits, h } from "./dom";
import { NONE, OPENED, openCss, ramp, rampCss, searched, searchedCss } from "./palette";
import type { Boxes, Nodes } from "./protocol";
import { thumbnails } from "./thumbnails";

type Colouring = "none" | "radius" | "searched";

interface Tree extends Nodes {
    triangles: Uint32Array;
}

export class CertificatesPanel {
    readonly element: HTMLElement;
    private readonly colouring: HTMLSelectElement;
    private readonly level: HTMLInputElement;
    private readonly levelText = h("output", {});
    private readonly boxes: HTMLInputElement;
    private readonly legend = h("div", { class: "ramp-legend", hidden: true });
    private tree: Promise<Tree> | null = null;
    private boxesFlying = false;
    private boxesStale = false;

    constructor(private readonly app: App) {
        const deepest = Math.max(1, ...app.shape.model.levels.map((l) => l.level));
        this.colouring = h(
            "select",
            { id: "colouring", onchange: () => this.recolour() },
            h("option", { value: "none" }, "plain"),
            h("option", { value: "radius" }, "nodes by radius"),
            h("option", { value: "searched" }, "nodes opened and culled"),
        );
        this.level = h("input", {
            type: "range",
            id: "level",
            min: 0,
            max: deepest,
            step: 1,
            value: Math.min(5, deepest),
            oninput: () => this.levelChanged(),
        });
        this.boxes = h("input", { type: "checkbox", id: "boxes", onchange: () => this.refreshBoxes() });
        const live = app.source.live && app.stage !== null;
        this.element = h(
            "div",
            { class: "certificates" },
            this.facts(),
            live && h("h2", {}, "On the shape"),
            live && h("label", { class: "field" }, h("span", {}, "colours"), this.colouring),
            live && this.legend,
            live && h("label", { class: "field" }, h("span", {}, "level"), this.level, this.levelText),
            live && h("label", { class: "check" }, this.boxes, "AABBs of this level"),
            app.shape.model.extremal.length > 0 && thumbnails(app),
        );
        this.levelText.textContent = this.level.value;
        if (!live) return;
        app.checker?.onAnswer(() => {
            if (this.colouring.value === "searched") void attempt(app, () => this.paintSearched());
        });
        app.pose.onChange(() => this.boxes.checked && this.refreshBoxes());
    }

    cycle(): void {
        const at = (this.colouring.selectedIndex + 1) % this.colouring.options.length;
        this.colouring.selectedIndex = at;
        this.recolour();
    }

    toggleBoxes(): void {
        this.boxes.checked = !this.boxes.checked;
        this.refreshBoxes();
    }

    private facts(): HTMLElement {
        const { model } = this.app.shape;
        const rows: [string, string][] = [
            ["root radius", digits(model.root_radius)],
            ...(model.resolved_up_to === null
                ? []
                : [["pair tree limit", digits(model.resolved_up_to)] as [string, string]]),
            ["global radius", digits(model.global_radius)],
            ["metric", model.metric],
            ["nodes", model.nodes.toLocaleString("en")],
            ["exceptions", model.exceptions === 0 ? "none" : model.exceptions.toLocaleString("en")],
        ];
        return h(
            "table",
            { class: "facts" },
            ...rows.map(([name, value]) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, value))),
        );
    }

    private levelChanged(): void {
        this.levelText.textContent = this.level.value;
        if (this.colouring.value === "radius") this.recolour();
        if (this.boxes.checked) this.refreshBoxes();
    }

    private recolour(): void {
        const { app } = this;
        const kind = this.colouring.value as Colouring;
        const { checker, pose } = app;
        const nodes = kind === "searched";
        this.legend.hidden = kind === "none";
        if (checker && checker.nodes !== nodes) {
            checker.nodes = nodes;
            if (nodes) void checker.check(pose.q, pose.serial);
        }
        void attempt(app, async () => {
            if (kind === "none") app.body?.setTints(null);
            if (kind === "radius") await this.paintRadius();
            if (kind === "searched") await this.paintSearched();
            app.frames.invalidate();
        });
    }

    private load(): Promise<Tree> {
        this.tree ??= this.request().catch((error) => {
            // The next colouring asks again.
            this.tree = null;
            throw error;
        });
        return this.tree;
    }

    private async request(): Promise<Tree> {
        const nodes = await this.app.source.ask<Nodes>("/api/nodes");
        const triangles = new Uint32Array(await this.app.source.array(nodes.order));
        return { ...nodes, triangles };
    }

    /** Colours each triangle by the radius of its node at the level, or of its deepest node above the level. */
    private async paintRadius(): Promise<void> {
        const tree = await this.load();
        // Another colouring may have been chosen meanwhile.
        if (this.colouring.value !== "radius") return;
        const level = this.level.valueAsNumber;
        const radii = tree.radius.filter((r): r is number => r !== null && r > 0);
        const [low, high] = [
            radii.reduce((a, b) => Math.min(a, b), 1e300),
            radii.reduce((a, b) => Math.max(a, b), 0),
        ];
        const span = Math.log(high / low) || 1;
        const bytes = this.blank();
        // Parents come before their children, so the deepest node sets the colour.
        for (let node = 0; node < tree.level.length; node++) {
            if (tree.level[node] > level) continue;
            const radius = tree.radius[node];
            const entry = radius === null ? NONE : Math.round((254 * Math.log(Math.max(radius, low) / low)) / span);
            this.fill(tree, node, bytes, entry);
        }
        this.app.body?.setTints({ bytes, palette: ramp });
        const bar = h("div", { class: "ramp" });
        bar.style.background = rampCss;
        this.legend.replaceChildren(h("span", {}, digits(low, 3)), bar, h("span", {}, digits(high, 3)));
    }

    private async paintSearched(): Promise<void> {
        const tree = await this.load();
        const nodes = this.app.checker?.answer?.nodes;
        if (!nodes || this.colouring.value !== "searched") return;
        const bytes = this.blank();
        const deepest = nodes.culled.reduce((deepest, node) => Math.max(deepest, tree.level[node]), 1);
        const shade = (node: number): number => Math.round(((OPENED - 1) * tree.level[node]) / deepest);
        // Culled nodes overwrite the opened nodes that contain them.
        for (const node of nodes.opened) this.fill(tree, node, bytes, OPENED);
        for (const node of nodes.culled) this.fill(tree, node, bytes, shade(node));
        this.app.body?.setTints({ bytes, palette: searched });
        const box = h("span", { class: "swatch" });
        box.style.background = openCss;
        const bar = h("div", { class: "ramp" });
        bar.style.background = searchedCss;
        const [culled, opened] = [nodes.culled, nodes.opened].map((list) => list.length.toLocaleString("en"));
        this.legend.replaceChildren(
            h("span", { class: "whole" }, `${culled} culled by certificates, ${opened} opened`),
            h("span", {}, "culled at the root"),
            bar,
            h("span", {}, `at level ${deepest}`),
            box,
            h("span", {}, "not culled"),
        );
        this.app.frames.invalidate();
    }

    private blank(): Uint8Array {
        return new Uint8Array(this.app.shape.model.triangles).fill(NONE);
    }

    private fill(tree: Tree, node: number, bytes: Uint8Array, entry: number): void {
        const end = tree.first[node] + tree.count[node];
        for (let i = tree.first[node]; i < end; i++) bytes[tree.triangles[i]] = entry;
    }

    private refreshBoxes(): void {
        const { app } = this;
        if (!this.boxes.checked) {
            app.stage?.setBoxes([]);
            return;
        }
        this.boxesStale = true;
        if (this.boxesFlying) return;
        this.boxesFlying = true;
        void attempt(app, async () => {
            try {
                while (this.boxesStale && this.boxes.checked) {
                    this.boxesStale = false;
                    const body = { q: [...app.pose.q], level: this.level.valueAsNumber };
                    const { boxes } = await app.source.ask<Boxes>("/api/boxes", body);
                    app.stage?.setBoxes(this.boxes.checked ? boxes : []);
                }
            } finally {
                this.boxesFlying = false;
            }
        });
    }
}
