/** Recorded motions: several bodies with q and rigid motion, or one body whose q moves the shape of the sliders. */
import * as THREE from "three";
import type { App } from "./app";
import type { Body } from "./body";
import type { MovingBody } from "./glb";
import type { PlaybackData } from "./protocol";
import type { Shape } from "./shape";
import type { Source } from "./source";

interface StagedBody {
    body: Body | null;
    instance: number;
    shape: Shape;
    q: Float32Array;
    rigid: Float32Array | null;
    center: number[];
    pairs: number[] | null;
}

interface Colliding {
    offsets: Uint32Array;
    triangles: Uint32Array;
}

export class Playback {
    private bodies: StagedBody[] = [];
    private marked = false;

    private constructor(
        private readonly app: App,
        readonly data: PlaybackData,
        private readonly shapes: Map<number, Shape>,
        private readonly tracks: { q: Float32Array; rigid: Float32Array | null }[],
        private readonly colliding: Colliding | null,
    ) {}

    static async load(
        app: App,
        source: Source,
        data: PlaybackData,
        shapeOf: (model: number) => Promise<Shape>,
    ): Promise<Playback> {
        const floats = async (name: string): Promise<Float32Array> => new Float32Array(await source.array(name));
        const shapes = new Map<number, Shape>();
        for (const body of data.bodies)
            if (!shapes.has(body.model)) shapes.set(body.model, await shapeOf(body.model));
        const tracks = await Promise.all(
            data.bodies.map(async (b) => ({
                q: await floats(b.q),
                rigid: b.rigid === null ? null : await floats(b.rigid),
            })),
        );
        let colliding: Colliding | null = null;
        if (data.colliding) {
            const [offsets, triangles] = await Promise.all([
                source.array(data.colliding.offsets),
                source.array(data.colliding.triangles),
            ]);
            colliding = { offsets: new Uint32Array(offsets), triangles: new Uint32Array(triangles) };
        }
        return new Playback(app, data, shapes, tracks, colliding);
    }

    /** Whether the recording is one body that only deforms: it moves the shape of the sliders. */
    get posed(): boolean {
        return this.data.bodies.length === 1 && this.data.bodies[0].rigid === null && this.data.ground === null;
    }

    get frames(): number {
        return this.data.times.length;
    }

    /** Colliding pairs of all bodies in each frame; null if unknown. */
    get pairs(): number[] | null {
        // Without `pairs_since`, pairs of a simulation are the maximum up to the next frame, not those of the frame.
        if (this.data.pairs_since === undefined && !this.posed) return null;
        const known = this.data.bodies.flatMap((b) => (b.pairs ? [b.pairs] : []));
        if (known.length === 0) return null;
        return this.data.times.map((_, t) => known.reduce((sum, pairs) => sum + pairs[t], 0));
    }

    /** The largest number of pairs in one step between the previous frame and each frame; null without such steps. */
    get since(): number[] | null {
        return this.data.pairs_since ?? null;
    }

    get moving(): MovingBody[] {
        return this.data.bodies.map((b, i) => ({
            ...this.tracks[i],
            name: b.name,
            shape: this.shapes.get(b.model)!,
            center: b.center,
        }));
    }

    row(body: number, frame: number): Float32Array {
        const { q } = this.tracks[body];
        const rank = q.length / this.frames;
        return q.subarray(frame * rank, (frame + 1) * rank);
    }

    /** Adds all bodies to the stage. */
    enter(): void {
        const { stage } = this.app;
        if (this.posed || !stage) return;
        stage.removeBodies();
        const perModel = new Map<number, number>();
        const instances = this.data.bodies.map((b) => {
            const n = perModel.get(b.model) ?? 0;
            perModel.set(b.model, n + 1);
            return n;
        });
        const made = new Map([...perModel].map(([model, n]) => [model, stage.addBody(this.shapes.get(model)!, n)]));
        this.bodies = this.data.bodies.map((b, i) => ({
            ...this.tracks[i],
            body: made.get(b.model)!,
            instance: instances[i],
            shape: this.shapes.get(b.model)!,
            center: b.center,
            pairs: b.pairs,
        }));
        const { middle, radius } = this.extent();
        stage.setGround(this.data.ground, radius * 4);
        stage.frame(middle, radius, "z");
    }

    /** Displays one frame as recorded. */
    show(frame: number): void {
        const { app } = this;
        const pairs = this.pairs;
        const recorded = { pairs: pairs?.[frame] ?? null, since: this.since?.[frame] ?? 0 };
        if (this.posed) {
            // A live page checks each frame again.
            if (app.checker) app.motion.propose(this.row(0, frame));
            else {
                app.recorded = pairs ? recorded : null;
                app.pose.show(this.row(0, frame));
                app.body?.setMarks(0, this.triangles(0, frame) ?? []);
            }
            return;
        }
        app.recorded = recorded;
        this.bodies.forEach((b, i) => {
            b.body?.setQ(b.instance, this.row(i, frame));
            b.body?.setMatrix(b.instance, this.matrix(b, frame));
        });
        this.mark(frame);
        app.frames.invalidate();
    }

    /** The colliding triangles of a body in a frame; null if they were not recorded. */
    triangles(body: number, frame: number): Uint32Array | null {
        if (!this.colliding) return null;
        const at = frame * this.data.bodies.length + body;
        return this.colliding.triangles.subarray(this.colliding.offsets[at], this.colliding.offsets[at + 1]);
    }

    private mark(frame: number): void {
        if (!this.colliding) return;
        const any = this.bodies.some((_, i) => (this.triangles(i, frame)?.length ?? 0) > 0);
        if (!any && !this.marked) return;
        this.marked = any;
        this.bodies.forEach((b, i) => {
            b.body?.setMarks(b.instance, this.triangles(i, frame) ?? []);
        });
    }

    /** x -> R (x - center) + place. */
    private matrix(b: StagedBody, frame: number): THREE.Matrix4 {
        if (!b.rigid) return new THREE.Matrix4();
        const [x, y, z, i, j, k, w] = b.rigid.subarray(7 * frame, 7 * frame + 7);
        const [cx, cy, cz] = b.center;
        return new THREE.Matrix4()
            .makeRotationFromQuaternion(new THREE.Quaternion(i, j, k, w))
            .setPosition(x, y, z)
            .multiply(new THREE.Matrix4().makeTranslation(-cx, -cy, -cz));
    }

    /** A ball around all bodies at all times, without bodies that fall far below the ground. */
    private extent(): { middle: [number, number, number]; radius: number } {
        const box = new THREE.Box3();
        for (const b of this.bodies) {
            for (let f = 0; f < this.frames; f += Math.max(1, Math.floor(this.frames / 12))) {
                const at = new THREE.Vector3(...b.shape.middle).applyMatrix4(this.matrix(b, f));
                const size = b.shape.radius * 0.8;
                if (this.data.ground !== null && at.z < this.data.ground - 4 * b.shape.radius) continue;
                box.expandByPoint(at.clone().addScalar(size)).expandByPoint(at.clone().addScalar(-size));
            }
        }
        const middle = box.getCenter(new THREE.Vector3());
        return { middle: [middle.x, middle.y, middle.z], radius: box.getSize(new THREE.Vector3()).length() / 2 || 1 };
    }
}
