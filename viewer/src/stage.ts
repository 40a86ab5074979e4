/** The picture: camera, renderer, bodies, ground and AABBs. */
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Body } from "./body";
import { Curves } from "./curves";
import type { Frames } from "./frames";
import { around, type Shape, type Vector } from "./shape";
import { colours } from "./theme";
import { bestView, type Surface } from "./view-of-pair";

/** Duration of a flight of the camera (ms). */
const FLIGHT = 450;

/** Largest number of cells along a side of the ground. */
const MAX_CELLS = 100;

/** The picture of a pair shows this multiple of its size. */
const FRAME_REACH = 5;

/** The smallest distance to a pair, as a share of the radius of the whole. */
const CLOSEST = 0.06;

/** The radius of the disc around a pair: a multiple of the pair's radius, but at least a share of the distance to the eye. */
const CUT_REACH = 2;
const CUT_SHARE = 0.08;

export class Stage {
    readonly scene = new THREE.Scene();
    readonly camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
    readonly bodies: Body[] = [];
    readonly curves = new Curves();
    private readonly renderer: THREE.WebGLRenderer;
    private controls: OrbitControls;
    private home = { middle: new THREE.Vector3(), radius: 1 };
    private ground: THREE.GridHelper | null = null;
    private boxes: THREE.LineSegments | null = null;
    /** The disc around the chosen pair: its middle and radius; radius 0: none. */
    private readonly cut = new THREE.Vector4(0, 0, 0, 0);
    private isCutting = true;
    /** How far `follow` has moved the view in all. */
    private readonly followed = new THREE.Vector3();
    private flights = 0;

    /** Throws if WebGL 2 is missing. */
    constructor(
        readonly canvas: HTMLCanvasElement,
        readonly frames: Frames,
    ) {
        const context = canvas.getContext("webgl2", {
            antialias: true,
            alpha: false,
            powerPreference: "high-performance",
        });
        if (!context) throw new Error("no WebGL 2");
        this.renderer = new THREE.WebGLRenderer({ canvas, context });
        this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
        this.scene.add(this.curves.group);
        this.controls = this.newControls();
        new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
        canvas.addEventListener("keydown", (event) => this.key(event));
        canvas.addEventListener("webglcontextrestored", () => this.frames.invalidate());
        this.resize();
    }

    get largestTexture(): number {
        return this.renderer.capabilities.maxTextureSize;
    }

    addBody(shape: Shape, instances: number): Body {
        const body = new Body(shape, instances, this.largestTexture);
        this.bodies.push(body);
        this.scene.add(body.group);
        this.recolour();
        return body;
    }

    removeBodies(): void {
        for (const body of this.bodies.splice(0)) {
            this.scene.remove(body.group);
            body.dispose();
        }
        this.curves.clear();
    }

    recolour(): void {
        const now = colours();
        this.scene.background = new THREE.Color(...now.background);
        for (const body of this.bodies) body.setColours(now, this.renderer.getPixelRatio());
        this.curves.setColours(now);
        if (this.ground) (this.ground.material as THREE.LineBasicMaterial).color.setRGB(...now.ground);
        if (this.boxes) (this.boxes.material as THREE.LineBasicMaterial).color.setRGB(...now.line);
        this.frames.invalidate();
    }

    /** Points the camera at a ball, from the front, slightly from above and from the side. */
    frame(middle: number[], radius: number, up: "y" | "z"): void {
        this.home = { middle: new THREE.Vector3(...middle), radius };
        this.camera.up.set(0, up === "y" ? 1 : 0, up === "z" ? 1 : 0);
        const aside = up === "y" ? new THREE.Vector3(0.45, 0.3, 1) : new THREE.Vector3(0.45, -1, 0.3);
        this.controls.dispose();
        this.controls = this.newControls();
        this.controls.target.copy(this.home.middle);
        this.camera.position.copy(this.home.middle).addScaledVector(aside.normalize(), this.distance(radius));
        this.controls.update();
        this.frames.invalidate();
    }

    /** The unit vector from the middle of the picture to the eye. */
    get toEye(): Vector {
        return this.camera.position.clone().sub(this.controls.target).normalize().toArray();
    }

    /** Flies to a pair of triangles, given by their corners, so that it is in front; cuts away what hides it. */
    flyTo(triangles: Vector[][], surfaces: Surface[]): void {
        const { middle, reach } = around(triangles);
        const normals = triangles.map(normal);
        const away = bestView(surfaces, middle, normals, this.toEye, this.camera.up.toArray());
        const closest = this.home.radius * CLOSEST;
        const distance = Math.min(
            Math.max(this.distance(reach * FRAME_REACH), closest),
            this.distance(this.home.radius),
        );
        this.cut.set(...middle, Math.max(reach * CUT_REACH, distance * CUT_SHARE));
        this.applyCut(true);
        this.fly(new THREE.Vector3(...middle), new THREE.Vector3(...away), distance);
    }

    /** Cuts nothing away. */
    endCut(): void {
        if (this.cut.w === 0) return;
        this.cut.w = 0;
        this.applyCut(true);
    }

    /** Shows the parts that are cut away, or hides them again. */
    toggleCut(): void {
        this.applyCut(!this.isCutting);
    }

    /** Moves camera and view by a vector. */
    follow(by: Vector): void {
        const shift = new THREE.Vector3(...by);
        for (const point of [this.camera.position, this.controls.target, this.home.middle, this.followed])
            point.add(shift);
        this.controls.update();
        this.frames.invalidate();
    }

    flyHome(): void {
        const { middle, radius } = this.home;
        this.endCut();
        this.fly(middle.clone(), new THREE.Vector3(...this.toEye), this.distance(radius));
    }

    /** Shows a grid at a height, about the point below `middle`; null: none. `cell`: the smallest size of its cells. */
    setGround(height: number | null, middle: Vector = [0, 0, 0], size = 1, cell = 1): void {
        if (this.ground) this.scene.remove(this.ground);
        this.ground = null;
        if (height !== null) {
            const cells = 2 * Math.ceil(Math.min(size / cell, MAX_CELLS) / 2);
            this.ground = new THREE.GridHelper(size, cells, 0xffffff, 0xffffff);
            this.ground.rotation.x = Math.PI / 2;
            this.ground.position.set(middle[0], middle[1], height);
            this.scene.add(this.ground);
        }
        this.recolour();
    }

    setBoxes(boxes: number[][]): void {
        if (this.boxes) {
            this.scene.remove(this.boxes);
            this.boxes.geometry.dispose();
        }
        this.boxes = null;
        if (boxes.length > 0) {
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute("position", new THREE.BufferAttribute(boxLines(boxes), 3));
            const material = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.75 });
            this.boxes = new THREE.LineSegments(geometry, material);
            this.boxes.frustumCulled = false;
            this.scene.add(this.boxes);
        }
        this.recolour();
    }

    /** Returns a picture of a body; `draw` sets its q first. */
    thumbnail(body: Body, draw: () => void, width: number, height: number): ImageData {
        const target = new THREE.WebGLRenderTarget(width, height, { samples: 4 });
        const camera = new THREE.PerspectiveCamera(32, width / height, this.camera.near, this.camera.far);
        const { shape } = body;
        const aside = this.camera.position.clone().sub(this.controls.target).normalize();
        camera.up.copy(this.camera.up);
        camera.position.set(...shape.middle).addScaledVector(aside, shape.radius * 3.9);
        camera.lookAt(...shape.middle);
        draw();
        this.renderer.setRenderTarget(target);
        this.renderer.render(this.scene, camera);
        const bytes = new Uint8Array(4 * width * height);
        this.renderer.readRenderTargetPixels(target, 0, 0, width, height, bytes);
        this.renderer.setRenderTarget(null);
        target.dispose();
        const image = new ImageData(width, height);
        for (let y = 0; y < height; y++) {
            image.data.set(bytes.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
        }
        return image;
    }

    png(): Promise<Blob | null> {
        this.draw();
        return new Promise((settle) => this.canvas.toBlob(settle, "image/png"));
    }

    draw(): void {
        this.curves.fit(this.renderer);
        this.renderer.render(this.scene, this.camera);
    }

    private newControls(): OrbitControls {
        const controls = new OrbitControls(this.camera, this.canvas);
        controls.addEventListener("change", () => this.frames.invalidate());
        controls.zoomToCursor = true;
        return controls;
    }

    /** The distance from which a ball fills the picture. Also sets the near and far planes by the radius of `home`. */
    private distance(radius: number): number {
        const narrow = Math.min(1, this.camera.aspect);
        const distance = (radius * 1.08) / Math.sin((this.camera.fov * Math.PI) / 360) / narrow;
        this.camera.near = this.home.radius / 200;
        this.camera.far = this.home.radius * 60;
        this.camera.updateProjectionMatrix();
        return distance;
    }

    /** Flies until the camera looks at the target from this direction and distance. */
    private fly(target: THREE.Vector3, away: THREE.Vector3, distance: number): void {
        const from = this.controls.target.clone();
        const offset = this.camera.position.clone().sub(from);
        const [farther, begun] = [offset.length(), this.followed.clone()];
        const turn = new THREE.Quaternion().setFromUnitVectors(offset.clone().normalize(), away);
        const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
        const flight = ++this.flights;
        let begin: number | null = null;
        this.frames.run((now) => {
            if (flight !== this.flights) return false;
            begin ??= now;
            const t = still ? 1 : Math.min(1, (now - begin) / FLIGHT);
            const s = t * t * (3 - 2 * t);
            const direction = offset.clone().normalize().applyQuaternion(new THREE.Quaternion().slerp(turn, s));
            // The body may move meanwhile.
            const moved = this.followed.clone().sub(begun);
            this.controls.target.lerpVectors(from, target, s).add(moved);
            this.camera.position
                .copy(this.controls.target)
                .addScaledVector(direction, farther * (distance / farther) ** s);
            this.controls.update();
            this.frames.invalidate();
            return t < 1;
        });
    }

    private applyCut(isCutting: boolean): void {
        this.isCutting = isCutting;
        for (const body of this.bodies) body.setCut(isCutting ? this.cut : new THREE.Vector4(0, 0, 0, 0));
        this.frames.invalidate();
    }

    private resize(): void {
        const { clientWidth, clientHeight } = this.canvas.parentElement!;
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.renderer.setSize(Math.max(1, clientWidth), Math.max(1, clientHeight), false);
        this.camera.aspect = Math.max(1, clientWidth) / Math.max(1, clientHeight);
        this.camera.updateProjectionMatrix();
        this.frames.invalidate();
    }

    /** Arrows rotate the view, plus and minus zoom. */
    private key(event: KeyboardEvent): void {
        const turns: Record<string, [number, number, number]> = {
            ArrowLeft: [-0.1, 0, 1],
            ArrowRight: [0.1, 0, 1],
            ArrowUp: [0, -0.1, 1],
            ArrowDown: [0, 0.1, 1],
            "+": [0, 0, 0.9],
            "=": [0, 0, 0.9],
            "-": [0, 0, 1 / 0.9],
        };
        const turn = turns[event.key];
        if (!turn || event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        const up = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
        const offset = this.camera.position.clone().sub(this.controls.target).applyQuaternion(up);
        const ball = new THREE.Spherical().setFromVector3(offset);
        ball.theta += turn[0];
        ball.phi += turn[1];
        ball.radius *= turn[2];
        ball.makeSafe();
        offset.setFromSpherical(ball).applyQuaternion(up.invert());
        this.camera.position.copy(this.controls.target).add(offset);
        this.controls.update();
        this.frames.invalidate();
    }
}

/** The normal of a triangle; its length is twice the area. */
function normal(corners: Vector[]): Vector {
    const [a, b, c] = corners.map((corner) => new THREE.Vector3(...corner));
    return b.sub(a).cross(c.sub(a)).toArray();
}

/** The twelve edges of each AABB. */
function boxLines(boxes: number[][]): Float32Array {
    const lines = new Float32Array(boxes.length * 72);
    let at = 0;
    for (const box of boxes) {
        for (let axis = 0; axis < 3; axis++) {
            for (let side = 0; side < 4; side++) {
                for (let end = 0; end < 2; end++) {
                    const upper = [0, 0, 0];
                    upper[axis] = end;
                    upper[(axis + 1) % 3] = side & 1;
                    upper[(axis + 2) % 3] = side >> 1;
                    for (let c = 0; c < 3; c++) lines[at++] = box[c + 3 * upper[c]];
                }
            }
        }
    }
    return lines;
}
