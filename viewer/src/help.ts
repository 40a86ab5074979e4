/** The help dialog: keys and answers. */
import { dismiss, h } from "./dom";

export const KEYS: [string, string][] = [
    ["drag, wheel, right drag", "rotate, zoom, pan (touch: one, two fingers)"],
    ["arrows, + −", "rotate and zoom, when the picture has the focus"],
    ["Space", "play or pause; without a recording vibrate the focused mode"],
    [", .", "previous, next frame"],
    ["[ ]", "focus the slider of the previous, next mode"],
    ["V", "vibrate the focused mode"],
    ["C", "move along a random direction to the first self-collision"],
    ["X", "show a random q"],
    ["R", "reset q to the centre"],
    ["L", "load q"],
    ["N, Shift+N", "fly to the next, previous colliding pair"],
    ["F", "show the whole shape"],
    ["U", "switch between z up and y up"],
    ["K", "switch colours: plain, by radius, opened and culled"],
    ["B", "show the AABBs of a level"],
    ["P, G", "save a picture, the motion as GLB"],
    ["T", "switch between light and dark"],
    ["?", "show this help"],
];

export function help(): void {
    const dialog = h(
        "dialog",
        { class: "dialog", "aria-label": "help" },
        h("h2", {}, "Keys"),
        h(
            "table",
            { class: "keys" },
            ...KEYS.map(([key, what]) =>
                h("tr", {}, h("th", { scope: "row" }, h("kbd", {}, key)), h("td", {}, what)),
            ),
        ),
        h(
            "p",
            {},
            "For the guarantee of each answer see docs/guarantees.md. " +
                "The gauge shows an answer only for the displayed shape, and “checking…” until it arrives.",
        ),
        h("button", { type: "button", class: "primary", onclick: () => dismiss(dialog) }, "Close"),
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
}
