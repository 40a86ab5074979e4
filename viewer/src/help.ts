/** What the keys do. */
import { dismiss, h } from "./dom";

export const KEYS: [string, string][] = [
    ["drag, wheel, right drag", "turn, come nearer, move (one, two fingers)"],
    ["arrows, + −", "the same, when the picture has the focus"],
    ["Space", "play or pause; else vibrate the mode in focus"],
    [", .", "one frame back, one frame on"],
    ["[ ]", "to the slider of the mode before, after"],
    ["V", "vibrate the mode in focus"],
    ["C", "along a random direction to the first self-collision"],
    ["X", "a random shape"],
    ["R", "reset q"],
    ["L", "load q"],
    ["N, Shift+N", "fly to the next, the previous colliding pair"],
    ["F", "see the whole shape again"],
    ["U", "turn upright: z or y up"],
    ["K", "colours: plain, by radius, opened and culled"],
    ["B", "boxes of a level"],
    ["P, G", "save a picture, the motion as GLB"],
    ["T", "light or dark"],
    ["?", "this help"],
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
            "“Free” is a proof: no two triangles without a common vertex have a point in common. " +
                "“Colliding” lists exactly the pairs that do. An answer counts only for the shape it was asked for; " +
                "until it comes, the gauge says so.",
        ),
        h("button", { type: "button", class: "primary", onclick: () => dismiss(dialog) }, "Close"),
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
}
