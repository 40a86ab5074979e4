/** Exports: a picture of the view, and the motion as GLB. */
import type { App } from "./app";
import { save } from "./dom";
import { type MovingBody, writeGlb } from "./glb";

/** Maximum number of frames of meshes in a GLB. */
const MAX_FRAMES = 1000;

function fileName(app: App, ending: string): string {
    return `${app.shape.model.name.replace(/[^\w.-]+/g, "_") || "shape"}.${ending}`;
}

export async function exportPng(app: App): Promise<void> {
    const blob = await app.stage?.png();
    if (!blob) throw new Error("there is no picture to save");
    save(fileName(app, "png"), blob);
    app.say(`saved ${fileName(app, "png")}`);
}

/** The last motion; without one, the line from the centre to the displayed q and back. */
export function track(app: App): { q: number[][]; times: number[] } {
    if (app.motion.track) return app.motion.track;
    const { center } = app.shape.model;
    const { q } = app.pose;
    const times = Array.from({ length: 61 }, (_, i) => i / 30);
    const rows = times.map((t) => center.map((c, k) => c + (q[k] - c) * (0.5 - 0.5 * Math.cos(Math.PI * t))));
    return { q: rows, times };
}

/** Saves the recording if it is displayed, else the last motion. Where there is a server, it writes the file of a motion. */
export async function exportGlb(app: App, recorded: { bodies: MovingBody[]; times: number[] } | null): Promise<void> {
    const { q, times } = track(app);
    const given = recorded?.bodies.some((body) => body.positions !== null) ?? false;
    // The weights of n frames are n x n numbers.
    if (recorded && given && recorded.times.length > MAX_FRAMES)
        throw new Error(
            `GLB holds at most ${MAX_FRAMES.toLocaleString("en")} frames, this recording has ` +
                `${recorded.times.length.toLocaleString("en")}: check fewer`,
        );
    let file: Blob;
    if (recorded) file = writeGlb(recorded.bodies, recorded.times);
    else if (app.source.live) {
        file = new Blob([await app.source.bytes("/api/glb", { q, times })], { type: "model/gltf-binary" });
    } else {
        const rows = Float32Array.from(q.flat());
        const { shape } = app;
        file = writeGlb(
            [{ name: shape.model.name, shape, q: rows, positions: null, rigid: null, center: [0, 0, 0] }],
            times,
        );
    }
    save(fileName(app, "glb"), file);
    app.say(`saved ${fileName(app, "glb")}: a morph target for each ${given ? "frame" : "mode that moves"}`);
}
