/** Small pictures of the largest certified deformations (paper, Figure 11). A click on a picture shows its deformation. */
import type { App } from "./app";
import { h } from "./dom";

const WIDTH = 148;
const HEIGHT = 108;

export function thumbnails(app: App): HTMLElement {
    const { extremal } = app.shape.model;
    // "mode 3 +", with the name of the mode.
    const named = (text: string): string => text.replace(/^mode (\d+)/, (_, k) => app.shape.modeName(Number(k)));
    const pictures = extremal.map(({ name, q }) => {
        const canvas = h("canvas", { width: 2 * WIDTH, height: 2 * HEIGHT, "aria-hidden": "true" });
        const show = (): void => {
            app.takeOver();
            app.pose.show(q);
        };
        const button = h(
            "button",
            { type: "button", class: "thumbnail", onclick: show },
            canvas,
            h("span", {}, named(name)),
        );
        return { button, canvas, q };
    });
    const element = h(
        "section",
        { "aria-label": "extremal deformations" },
        h("h2", {}, "Extremal deformations"),
        h(
            "p",
            { class: "hint" },
            "Shapes at the root's radius: the root's certificate proves all smaller deformations free.",
        ),
        h("div", { class: "thumbnails" }, ...pictures.map((p) => p.button)),
    );
    const draw = (): void => {
        const { stage, body } = app;
        if (!stage || !body) return;
        body.setPlain(true);
        for (const { canvas, q } of pictures) {
            const image = stage.thumbnail(body, () => body.setQ(0, q), canvas.width, canvas.height);
            canvas.getContext("2d")?.putImageData(image, 0, 0);
        }
        body.setPlain(false);
        body.setQ(0, app.pose.q);
        app.frames.invalidate();
    };
    // Draws them when they first become visible.
    new IntersectionObserver((entries, observer) => {
        if (!entries.some((e) => e.isIntersecting)) return;
        observer.disconnect();
        draw();
    }).observe(element);
    return element;
}
