/** The help dialog: keys and answers. */
import { dismiss, h } from "./dom";

/** What a page needs so that a key works: modes, the server, or a list of pairs. */
export type Need = "modes" | "server" | "pairs";

/** Keys, what they do, and what they need. */
export const KEYS: [string, string, Need?][] = [
    ["drag, wheel, right drag", "rotate, zoom, pan (touch: one, two fingers)"],
    ["arrows, + −", "rotate and zoom, when the picture has the focus"],
    ["Space", "play or pause; without a recording vibrate the focused mode"],
    [", .", "previous, next frame"],
    ["[ ]", "focus the slider of the previous, next mode", "modes"],
    ["/", "filter the modes by name", "modes"],
    ["V", "vibrate the focused mode", "modes"],
    ["C", "move along a random direction to the first self-collision", "server"],
    ["X", "show a random q", "modes"],
    ["R", "reset q to the centre", "modes"],
    ["L", "load q", "modes"],
    ["N, Shift+N", "fly to the next, previous colliding pair", "pairs"],
    ["H", "show or hide what is cut away in front of the pair", "pairs"],
    ["F", "show the whole shape"],
    ["U", "switch between z up and y up"],
    ["K", "switch colours: plain, by radius, opened and culled", "server"],
    ["B", "show the AABBs of a level", "server"],
    ["P, G", "save a picture, the motion as GLB"],
    ["T", "switch between light and dark"],
    ["?", "show this help"],
];

/** Shows the keys that work on a page with these parts. */
export function help(has: Record<Need, boolean>): void {
    const keys = KEYS.filter(([, , need]) => need === undefined || has[need]);
    const dialog = h(
        "dialog",
        { class: "dialog", "aria-label": "help" },
        h("h2", {}, "Keys"),
        h(
            "table",
            { class: "keys" },
            ...keys.map(([key, what]) =>
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
