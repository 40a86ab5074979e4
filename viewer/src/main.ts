/** The page of sscc: a shape, its certificates and its collisions; live, or a report. */
import "./style.css";
import { count, h } from "./dom";
import { Layout } from "./layout";
import { isMesh } from "./mesh";
import { page } from "./page";
import type { Scene } from "./protocol";
import { openSource } from "./source";

function size(scene: Scene): string {
    const { models, playback } = scene;
    const [first] = models;
    if (!first) return "";
    if (!isMesh(first)) return `${count(first.triangles, "triangle")}, ${count(first.rank, "mode")}`;
    const triangles = models.reduce((sum, model) => sum + model.triangles, 0);
    return `${count(triangles, "triangle")}, ${count(playback?.times.length ?? 0, "frame")}`;
}

async function start(): Promise<void> {
    const root = document.getElementById("app")!;
    try {
        const source = await openSource();
        const layout = new Layout(root);
        layout.title(source.scene.title, size(source.scene));
        await page(source, layout);
    } catch (error) {
        root.append(h("p", { class: "fatal", role: "alert" }, (error as Error).message));
    }
    document.documentElement.dataset.ready = "true";
}

void start();
