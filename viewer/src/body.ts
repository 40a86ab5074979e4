/** All instances of one model in one draw call: one mesh and one texture of modes for any number of bodies. */
import * as THREE from "three";
import { corners } from "./corners";
import { fragmentShader, hiddenShader, vertexShader } from "./shaders";
import type { Shape } from "./shape";
import type { Colours } from "./theme";

const MARKS_SHIFT = 11;
const WIDTH = 1 << MARKS_SHIFT;

function dataTexture(
    data: Float32Array | Uint8Array,
    width: number,
    format: THREE.PixelFormat,
    type: THREE.TextureDataType,
): THREE.DataTexture {
    const channels = format === THREE.RGBAFormat ? 4 : format === THREE.RGFormat ? 2 : 1;
    const texture = new THREE.DataTexture(
        data as BufferSource & Float32Array,
        width,
        data.length / channels / width,
        format,
        type,
    );
    texture.needsUpdate = true;
    return texture;
}

/** The modes as a texture of 2^shift columns; null if it is larger than the graphics card allows. */
function modesTexture(shape: Shape, largest: number): { texture: THREE.DataTexture; shift: number } | null {
    const n = shape.modes.length / 3;
    let shift = MARKS_SHIFT;
    while (1 << (shift + 1) <= largest && n > 1 << (2 * shift)) shift++;
    const width = 1 << shift;
    const rows = Math.max(1, Math.ceil(n / width));
    if (rows > largest) return null;
    const data = new Float32Array(4 * width * rows);
    for (let i = 0; i < n; i++) {
        data[4 * i] = shape.modes[3 * i];
        data[4 * i + 1] = shape.modes[3 * i + 1];
        data[4 * i + 2] = shape.modes[3 * i + 2];
    }
    return { texture: dataTexture(data, width, THREE.RGBAFormat, THREE.FloatType), shift };
}

export class Body {
    readonly group = new THREE.Group();
    private readonly geometry = new THREE.BufferGeometry();
    private readonly hiddenGeometry = new THREE.BufferGeometry();
    private readonly index: Uint32Array;
    private readonly source: Uint32Array;
    private readonly material: THREE.ShaderMaterial;
    private readonly hiddenMaterial: THREE.ShaderMaterial;
    private readonly mesh: THREE.InstancedMesh;
    private readonly hidden: THREE.InstancedMesh;
    private readonly onCard: boolean;
    private readonly weights: THREE.DataTexture;
    private readonly marks: THREE.DataTexture;
    private readonly marked: Set<number> = new Set();

    constructor(
        readonly shape: Shape,
        readonly instances: number,
        largestTexture: number,
    ) {
        const { model } = shape;
        const copies = corners(shape.faces, model.vertices);
        this.index = copies.index;
        this.source = copies.source;
        const position = new THREE.BufferAttribute(new Float32Array(3 * copies.source.length), 3);
        for (const geometry of [this.geometry, this.hiddenGeometry]) {
            geometry.setAttribute("position", position);
            geometry.setAttribute("source", new THREE.BufferAttribute(copies.source, 1));
        }
        this.geometry.setIndex(new THREE.BufferAttribute(copies.index, 1));
        this.hiddenGeometry.setIndex(new THREE.BufferAttribute(new Uint32Array(0), 1));

        const modes = modesTexture(shape, largestTexture);
        this.onCard = modes !== null && model.rank + 1 <= largestTexture;
        this.place(shape.positions);
        const width = this.onCard ? model.rank + 1 : 1;
        this.weights = dataTexture(new Float32Array(2 * width * instances), width, THREE.RGFormat, THREE.FloatType);
        const rows = Math.max(1, Math.ceil((model.triangles * instances) / WIDTH));
        this.marks = dataTexture(new Uint8Array(WIDTH * rows), WIDTH, THREE.RedFormat, THREE.UnsignedByteType);
        const tintRows = Math.max(1, Math.ceil(model.triangles / WIDTH));
        const tints = dataTexture(new Uint8Array(WIDTH * tintRows), WIDTH, THREE.RedFormat, THREE.UnsignedByteType);
        const palette = dataTexture(new Uint8Array(4 * 256), 256, THREE.RGBAFormat, THREE.UnsignedByteType);

        const uniforms = {
            modes: { value: modes?.texture ?? null },
            modesShift: { value: modes?.shift ?? 0 },
            weights: { value: this.weights },
            vertices: { value: model.vertices },
            triangles: { value: model.triangles },
            marks: { value: this.marks },
            marksShift: { value: MARKS_SHIFT },
            tints: { value: tints },
            palette: { value: palette },
            tinted: { value: false },
            plain: { value: false },
            base: { value: new THREE.Vector3() },
            hit: { value: new THREE.Vector3() },
            hitDark: { value: new THREE.Vector3() },
            chosen: { value: new THREE.Vector3() },
            stripe: { value: 9 },
            cut: { value: new THREE.Vector4(0, 0, 0, 0) },
        };
        this.material = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader,
            fragmentShader,
            uniforms,
            side: THREE.DoubleSide,
        });
        this.hiddenMaterial = new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader,
            fragmentShader: hiddenShader,
            uniforms,
            side: THREE.DoubleSide,
            transparent: true,
            depthWrite: false,
            depthFunc: THREE.GreaterDepth,
        });
        this.mesh = new THREE.InstancedMesh(this.geometry, this.material, instances);
        // Hidden triangles are shown only for the first instance: with many bodies they would be confusing.
        this.hidden = new THREE.InstancedMesh(this.hiddenGeometry, this.hiddenMaterial, 1);
        this.hidden.renderOrder = 1;
        // Its shader is compiled at the first collision.
        this.hidden.visible = false;
        for (const mesh of [this.mesh, this.hidden]) {
            mesh.frustumCulled = false;
            for (let i = 0; i < mesh.count; i++) mesh.setMatrixAt(i, new THREE.Matrix4());
            this.group.add(mesh);
        }
    }

    setColours(colours: Colours, pixels: number): void {
        const { uniforms } = this.material;
        uniforms.base.value.set(...colours.base);
        uniforms.hit.value.set(...colours.hit);
        uniforms.hitDark.value.set(...colours.hitDark);
        uniforms.chosen.value.set(...colours.chosen);
        uniforms.stripe.value = 9 * pixels;
    }

    /** Cuts away the parts that hide a disc from the eye. `cut`: middle and radius of the disc in the world; radius 0: no cut. */
    setCut(cut: THREE.Vector4): void {
        this.material.uniforms.cut.value.copy(cut);
    }

    setQ(instance: number, q: ArrayLike<number>): void {
        if (!this.onCard) {
            this.place(this.shape.deformed(q));
            return;
        }
        const data = this.weights.image.data as Float32Array;
        const start = 2 * instance * (this.shape.model.rank + 1);
        let used = 0;
        for (let k = 0; k < q.length; k++) {
            if (q[k] === 0) continue;
            used++;
            data[start + 2 * used] = k;
            data[start + 2 * used + 1] = q[k];
        }
        data[start] = used;
        this.weights.needsUpdate = true;
    }

    setMatrix(instance: number, matrix: THREE.Matrix4): void {
        this.mesh.setMatrixAt(instance, matrix);
        this.mesh.instanceMatrix.needsUpdate = true;
        if (instance === 0) {
            this.hidden.setMatrixAt(0, matrix);
            this.hidden.instanceMatrix.needsUpdate = true;
        }
    }

    /** Marks triangles of one instance as colliding, and some as chosen. */
    setMarks(instance: number, colliding: Iterable<number>, chosen: Iterable<number> = []): void {
        const data = this.marks.image.data as Uint8Array;
        const { triangles } = this.shape.model;
        const start = instance * triangles;
        for (const at of this.marked) {
            if (at < start || at >= start + triangles) continue;
            data[at] = 0;
            this.marked.delete(at);
        }
        const list: number[] = [];
        const mark = (t: number, kind: number): void => {
            if (t >= triangles) return;
            if (!data[start + t]) list.push(t);
            data[start + t] = kind;
            this.marked.add(start + t);
        };
        for (const t of colliding) mark(t, 1);
        for (const t of chosen) mark(t, 2);
        this.marks.needsUpdate = true;
        if (instance !== 0) return;
        const index = new Uint32Array(3 * list.length);
        list.forEach((t, i) => {
            for (let c = 0; c < 3; c++) index[3 * i + c] = this.index[3 * t + c];
        });
        this.hiddenGeometry.index?.array && this.hiddenGeometry.dispose();
        this.hiddenGeometry.setIndex(new THREE.BufferAttribute(index, 1));
        this.hidden.visible = list.length > 0;
    }

    /** The marked triangles of one instance, ascending. */
    markedTriangles(instance: number): number[] {
        const { triangles } = this.shape.model;
        const start = instance * triangles;
        return [...this.marked]
            .filter((at) => at >= start && at < start + triangles)
            .map((at) => at - start)
            .sort((a, b) => a - b);
    }

    /** Colours all triangles by a table of 256 colours; null: the plain colour. */
    setTints(tints: { bytes: Uint8Array; palette: Uint8Array } | null): void {
        const { uniforms } = this.material;
        uniforms.tinted.value = tints !== null;
        if (!tints) return;
        (uniforms.tints.value.image.data as Uint8Array).set(tints.bytes);
        (uniforms.palette.value.image.data as Uint8Array).set(tints.palette);
        uniforms.tints.value.needsUpdate = true;
        uniforms.palette.value.needsUpdate = true;
    }

    /** Turns marks and tints off or on. */
    setPlain(plain: boolean): void {
        this.material.uniforms.plain.value = plain;
        this.hidden.visible = !plain && (this.hiddenGeometry.index?.count ?? 0) > 0;
    }

    dispose(): void {
        const { uniforms } = this.material;
        for (const name of ["modes", "weights", "marks", "tints", "palette"]) uniforms[name].value?.dispose();
        this.geometry.dispose();
        this.hiddenGeometry.dispose();
        this.material.dispose();
        this.hiddenMaterial.dispose();
        this.mesh.dispose();
        this.hidden.dispose();
    }

    /** Sets the positions of the vertices, which all instances share. On the graphics card, U q is added to them. */
    place(positions: Float32Array): void {
        const attribute = this.geometry.getAttribute("position") as THREE.BufferAttribute;
        const { source } = this;
        for (let i = 0; i < source.length; i++) {
            for (let c = 0; c < 3; c++) attribute.array[3 * i + c] = positions[3 * source[i] + c];
        }
        attribute.needsUpdate = true;
    }
}
