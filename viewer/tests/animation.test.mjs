// Positions of animated glTF files, as `sscc check --animation --pose` writes them, against those of three.js.
//
// Where three.js deviates from the glTF specification, it is corrected here: it interpolates rotations linearly where they
// differ by less than 1.8 degrees, and does not normalize quaternions. Four weights for each vertex are its limit; the
// files have no more. Weights are normalized in both.
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath } from "node:url";
import { AnimationMixer, Quaternion, Vector3 } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { run } from "./command.mjs";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const folder = join(process.env.SSCC_MODELS ?? join(root, "../shared/models"), "skinned");
const out = mkdtempSync(join(tmpdir(), "sscc-animation-"));
after(() => rmSync(out, { recursive: true, force: true }));

// Node has no such class; the loader of three.js needs it.
globalThis.ProgressEvent ??= class extends Event {};

/** Interpolates rotations on the sphere, by the angle between the unit quaternions, and normalizes the result. */
Quaternion.slerpFlat = (result, at, a, atA, b, atB, t) => {
    const [x, y] = [Array.from(a.slice(atA, atA + 4)), Array.from(b.slice(atB, atB + 4))];
    const dot = x.reduce((sum, value, i) => sum + value * y[i], 0);
    const angle = Math.acos(Math.min(Math.abs(dot) / Math.hypot(...x) / Math.hypot(...y), 1));
    const [s, u] = angle === 0 ? [1 - t, t] : [Math.sin((1 - t) * angle), Math.sin(t * angle)];
    const sum = x.map((value, i) => s * value + Math.sign(dot) * u * y[i]);
    const length = Math.hypot(...sum);
    for (let i = 0; i < 4; i++) result[at + i] = sum[i] / length;
};

/** The scene of a file without images, which Node cannot decode. */
async function load(file) {
    let bytes = readFileSync(file);
    let binary = null;
    if (bytes.toString("latin1", 0, 4) === "glTF") {
        const length = bytes.readUInt32LE(12);
        const rest = bytes.subarray(20 + length);
        if (rest.length > 8) binary = rest.subarray(8, 8 + rest.readUInt32LE(0));
        bytes = bytes.subarray(20, 20 + length);
    }
    const json = JSON.parse(bytes.toString("utf8"));
    for (const key of ["images", "textures", "samplers", "materials"]) delete json[key];
    json.extensionsUsed = [];
    for (const primitive of json.meshes.flatMap((mesh) => mesh.primitives)) delete primitive.material;
    for (const buffer of json.buffers) {
        if (!buffer.uri) buffer.uri = `data:application/octet-stream;base64,${binary.toString("base64")}`;
        else if (!buffer.uri.startsWith("data:")) {
            const data = readFileSync(join(dirname(file), decodeURIComponent(buffer.uri))).toString("base64");
            buffer.uri = `data:application/octet-stream;base64,${data}`;
        }
    }
    return new GLTFLoader().parseAsync(JSON.stringify(json), "");
}

/** World positions of the vertices of a node's mesh, primitive by primitive. */
async function positions(gltf, node) {
    const object = await gltf.parser.getDependency("node", node);
    const json = gltf.parser.json.nodes[node];
    const skinned = [];
    object.traverse((child) => {
        const owner = gltf.parser.associations.get(child);
        if (child.isMesh && owner?.meshes === json.mesh) skinned.push(child);
    });
    skinned.sort((a, b) => gltf.parser.associations.get(a).primitives - gltf.parser.associations.get(b).primitives);
    return skinned.flatMap((mesh) => {
        const count = mesh.geometry.attributes.position.count;
        return Array.from({ length: count }, (_, i) => {
            const x = mesh.getVertexPosition(i, new Vector3());
            return x.applyMatrix4(mesh.matrixWorld);
        });
    });
}

/** The vertices of an OBJ file. */
function vertices(file) {
    const lines = readFileSync(file, "utf8").split("\n");
    const ofVertices = lines.filter((line) => line.startsWith("v "));
    return ofVertices.map((line) => new Vector3(...line.split(" ").slice(1, 4).map(Number)));
}

test("animated positions are those of three.js", async () => {
    if (!existsSync(folder)) {
        assert.ok(!process.env.SSCC_NO_SKIPS, `${folder}: not found`);
        console.log(`# skipped: ${folder}: not found; set SSCC_MODELS to the folder of models`);
        return;
    }
    let compared = 0;
    for (const name of readdirSync(folder).filter((name) => name.endsWith(".answers.json"))) {
        const records = JSON.parse(readFileSync(join(folder, name), "utf8"));
        const file = join(folder, records[0].file);
        const gltf = await load(file);
        for (const record of records.filter((r) => r.weights === "normalized" || r.largest_weight_sum_error < 1e-3)) {
            const mixer = new AnimationMixer(gltf.scene);
            mixer.clipAction(gltf.animations[record.animation]).play();
            const times = record.frames.map((frame) => frame.time);
            for (const time of [times[0], times[Math.floor(times.length / 2)], times.at(-1)]) {
                mixer.setTime(time);
                gltf.scene.updateMatrixWorld(true);
                const expected = await positions(gltf, record.node);
                const pose = join(out, "pose.obj");
                const at = [`--animation=${record.animation}`, `--node=${record.node}`, `--times=${time}`];
                await run("check", file, ...at, "--pose", pose, "--json");
                const found = vertices(pose);
                assert.equal(found.length, expected.length, name);
                const extent = ["x", "y", "z"].map((axis) => {
                    const values = found.map((x) => x[axis]);
                    return values.reduce((a, b) => Math.max(a, b)) - values.reduce((a, b) => Math.min(a, b));
                });
                const size = Math.hypot(...extent);
                const error = found.reduce((worst, x, i) => Math.max(worst, x.distanceTo(expected[i])), 0);
                assert.ok(error <= 1e-6 * size, `${name} ${at.join(" ")}: ${error / size} of the size`);
                compared++;
            }
            mixer.stopAllAction();
            mixer.uncacheRoot(gltf.scene);
        }
    }
    assert.ok(compared >= 30, `${compared}`);
    console.log(`# ${compared} shapes compared`);
});
