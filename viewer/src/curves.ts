/** The curves in which surfaces intersect: segments of a fixed width in pixels, above the surface. */
import * as THREE from "three";
import { curveFragmentShader, curveVertexShader } from "./shaders";
import type { Colours } from "./theme";

/** Width of a curve with its edges (pixels). */
const WIDTH = 4.5;

export class Curves {
    readonly group = new THREE.Group();
    private readonly size = new THREE.Vector2(1, 1);
    private readonly uniforms = {
        size: { value: this.size },
        width: { value: WIDTH },
        core: { value: new THREE.Vector3() },
        edge: { value: new THREE.Vector3() },
    };
    /** Curves behind a surface show through. */
    private readonly materials = [this.material(THREE.GreaterDepth, 0.4), this.material(THREE.LessEqualDepth, 1)];
    private geometry: THREE.InstancedBufferGeometry | null = null;

    /** Shows segments of two points each. */
    show(segments: Float32Array): void {
        this.clear();
        if (segments.length === 0) return;
        const geometry = new THREE.InstancedBufferGeometry();
        const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
        geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
        geometry.setIndex([0, 1, 2, 0, 2, 3]);
        const ends = new THREE.InstancedInterleavedBuffer(segments, 6);
        geometry.setAttribute("begin", new THREE.InterleavedBufferAttribute(ends, 3, 0));
        geometry.setAttribute("end", new THREE.InterleavedBufferAttribute(ends, 3, 3));
        geometry.instanceCount = segments.length / 6;
        this.geometry = geometry;
        this.materials.forEach((material, i) => {
            const mesh = new THREE.Mesh(geometry, material);
            mesh.frustumCulled = false;
            mesh.renderOrder = 2 + i;
            this.group.add(mesh);
        });
    }

    /** Number of displayed segments. */
    get count(): number {
        return this.geometry?.instanceCount ?? 0;
    }

    setColours(colours: Colours): void {
        this.uniforms.core.value.set(...colours.curve);
        this.uniforms.edge.value.set(...colours.curveEdge);
    }

    /** Takes the size of the picture, before it is drawn. */
    fit(renderer: THREE.WebGLRenderer): void {
        renderer.getDrawingBufferSize(this.size);
        this.uniforms.width.value = WIDTH * renderer.getPixelRatio();
    }

    clear(): void {
        this.group.clear();
        this.geometry?.dispose();
        this.geometry = null;
    }

    private material(depthFunc: THREE.DepthModes, opacity: number): THREE.ShaderMaterial {
        return new THREE.ShaderMaterial({
            glslVersion: THREE.GLSL3,
            vertexShader: curveVertexShader,
            fragmentShader: curveFragmentShader,
            uniforms: { ...this.uniforms, opacity: { value: opacity } },
            side: THREE.DoubleSide,
            transparent: true,
            depthWrite: false,
            depthFunc,
        });
    }
}
