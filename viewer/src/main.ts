/** The page of sscc: a shape, its certificates and its collisions; live, or a report. */
import "./style.css";
import { count, h } from "./dom";
import { Layout } from "./layout";
import { page } from "./page";
import { openSource } from "./source";

async function start(): Promise<void> {
    const root = document.getElementById("app")!;
    try {
        const source = await openSource();
        const layout = new Layout(root);
        const [first] = source.scene.models;
        const size = first ? `${count(first.triangles, "triangle")}, ${count(first.rank, "mode")}` : "";
        layout.title(source.scene.title, size);
        await page(source, layout);
    } catch (error) {
        root.append(h("p", { class: "fatal", role: "alert" }, (error as Error).message));
    }
    document.documentElement.dataset.ready = "true";
}

void start();
