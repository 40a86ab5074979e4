// Reads and plays GLB by three.js.
import { AnimationMixer } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

export async function parse(bytes) {
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
    return new GLTFLoader().parseAsync(buffer, "");
}

/** Whether all weights of morph targets are in [0, 1], since programs may clamp them. */
export function isBounded(gltf) {
    const tracks = gltf.animations[0].tracks.filter((track) => track.name.endsWith(".morphTargetInfluences"));
    return tracks.length > 0 && tracks.every(({ values }) => values.every((w) => w >= 0 && w <= 1));
}

/** Positions of the first mesh, or of one by name, at a time of the first animation, in the world. */
export function atTime(gltf, time, name) {
    const mixer = new AnimationMixer(gltf.scene);
    const action = mixer.clipAction(gltf.animations[0]);
    action.play();
    mixer.setTime(time);
    gltf.scene.updateMatrixWorld(true);
    let mesh = null;
    gltf.scene.traverse((node) => {
        if (node.isMesh && (!name || node.name === name)) mesh ??= node;
    });
    const positions = [];
    const point = mesh.position.clone();
    for (let v = 0; v < mesh.geometry.attributes.position.count; v++) {
        mesh.getVertexPosition(v, point).applyMatrix4(mesh.matrixWorld);
        positions.push(point.x, point.y, point.z);
    }
    return positions;
}
