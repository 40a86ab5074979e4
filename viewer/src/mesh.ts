/** Meshes without modes in the form of models: rank 0, no metric and no certificates. */
import type { Model, Scene } from "./protocol";

const NO_MODES = {
    rank: 0,
    frequencies: null,
    mode_names: null,
    scales: null,
    center: [],
    default_q: [],
    limits: [],
    root_radius: 0,
    global_radius: 0,
    resolved_up_to: null,
    metric: "none",
    exceptions: 0,
    nodes: 0,
    levels: [],
    extremal: [],
};

export function isMesh(model: Model): boolean {
    return model.arrays.modes === undefined;
}

/** Gives the meshes of a scene the fields that only models with modes have. */
export function completeScene(scene: Scene): Scene {
    return { ...scene, models: scene.models.map((model) => (isMesh(model) ? { ...NO_MODES, ...model } : model)) };
}
