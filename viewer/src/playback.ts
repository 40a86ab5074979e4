/**
 * Recorded motions: several bodies with q and rigid motion, one body whose q moves the shape of the sliders, or meshes
 * with the positions of each frame.
 */
import * as THREE from "three";
import type { App } from "./app";
import type { Body } from "./body";
import { type Contact, Contacts } from "./contacts";
import { type Ball, ballAround, ballOfPoints, Framing } from "./framing";
import type { MovingBody } from "./glb";
import type { PlaybackData } from "./protocol";
import type { Shape, Vector } from "./shape";
import type { Source } from "./source";

interface Track {
    /** Empty for positions. */
    q: Float32Array;
    /** Positions of all frames, relative to the centre. */
    positions: Float32Array | null;
    rigid: Float32Array | null;
}

interface StagedBody extends Track {
    body: Body | null;
    instance: number;
    shape: Shape;
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
    private framing: Framing | null = null;

    private constructor(
        private readonly app: App,
        readonly data: PlaybackData,
        private readonly shapes: Map<number, Shape>,
        private readonly tracks: Track[],
        private readonly colliding: Colliding | null,
        readonly contacts: Contacts | null,
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
                q: b.q === undefined ? new Float32Array(0) : await floats(b.q),
                positions: b.positions === undefined ? null : await floats(b.positions),
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
        tracks.forEach(({ positions }, i) => {
            const { name, model } = data.bodies[i];
            if (positions && positions.length !== data.times.length * shapes.get(model)!.positions.length)
                throw new Error(`the positions of ${name} have a wrong size: write the report anew`);
        });
        return new Playback(app, data, shapes, tracks, colliding, await Contacts.load(source, data));
    }

    /** Whether the recording has the positions of meshes without modes. */
    get given(): boolean {
        return this.tracks.some((track) => track.positions !== null);
    }

    /** Whether the recording is one body that only deforms, without a ground: it moves the shape of the sliders. */
    get posed(): boolean {
        const { bodies, ground } = this.data;
        return !this.given && bodies.length === 1 && bodies[0].rigid === null && ground === null;
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

    /** Adds all bodies to the stage. `up`: the upper side of meshes; that of simulations is z. */
    enter(up: "y" | "z"): void {
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
        this.framing = new Framing(this.frames, (frame) => this.ball(frame));
        const { flight, radius } = this.framing;
        stage.setGround(this.data.ground, flight.middle.toArray(), 6 * radius + 2 * flight.length, radius / 4);
        this.look(this.given ? up : "z");
    }

    /** Points the camera at the bodies. */
    look(up: "y" | "z"): void {
        if (this.framing) this.app.stage?.frame(this.framing.middle, this.framing.radius, up);
    }

    /** Displays one frame as recorded. */
    show(frame: number): void {
        const { app } = this;
        const pairs = this.pairs;
        const recorded = {
            pairs: pairs?.[frame] ?? null,
            since: this.since?.[frame] ?? 0,
            apart: this.data.apart ?? "",
        };
        if (this.posed) {
            // A page that can check q checks each frame again.
            if (app.checker) app.motion.propose(this.row(0, frame));
            else {
                app.recorded = pairs ? recorded : null;
                app.pose.show(this.row(0, frame));
                app.body?.setMarks(0, this.triangles(0, frame) ?? []);
            }
            return;
        }
        app.recorded = { ...recorded, impact: this.contacts?.impact(frame), isEnd: this.isEnd(frame) };
        this.bodies.forEach((b, i) => {
            if (b.positions) b.body?.place(this.positions(i, frame)!);
            else b.body?.setQ(b.instance, this.row(i, frame));
            b.body?.setMatrix(b.instance, this.matrix(b, frame));
        });
        const moved = this.framing?.follow(frame);
        if (moved) app.stage?.follow(moved);
        app.stage?.endCut();
        this.mark(frame);
        if (this.contacts) app.stage?.curves.show(this.contacts.curves(frame));
        app.frames.invalidate();
    }

    /** Whether a frame is the last one of a continuous check: no step follows. */
    isEnd(frame: number): boolean {
        return (this.contacts?.isContinuous ?? false) && frame === this.frames - 1;
    }

    /** The positions of a body in a frame; null if it deforms by q. */
    positions(body: number, frame: number): Float32Array | null {
        const { positions } = this.tracks[body];
        if (!positions) return null;
        const size = positions.length / this.frames;
        return positions.subarray(frame * size, (frame + 1) * size);
    }

    /** Marks the pair of a frame, and flies to it. */
    choose(contact: Contact, frame: number): void {
        const faces = (body: number): Uint32Array => this.shapes.get(this.data.bodies[body].model)!.faces;
        const triangles = contact.bodies.map((body, side) => {
            const x = this.positions(body, frame)!;
            return [0, 1, 2].map((c): Vector => {
                const v = 3 * faces(body)[3 * contact.pair[side] + c];
                return [x[v], x[v + 1], x[v + 2]];
            });
        });
        const surfaces = this.data.bodies.map((_, body) => ({
            positions: this.positions(body, frame)!,
            faces: faces(body),
            own: contact.pair.filter((_, side) => contact.bodies[side] === body),
        }));
        this.mark(frame, contact);
        this.app.stage?.flyTo(triangles, surfaces);
        this.app.frames.invalidate();
    }

    /** The colliding triangles of a body in a frame; null if they were not recorded. */
    triangles(body: number, frame: number): Uint32Array | null {
        if (this.contacts) return this.contacts.triangles(frame, body);
        if (!this.colliding) return null;
        const at = frame * this.data.bodies.length + body;
        return this.colliding.triangles.subarray(this.colliding.offsets[at], this.colliding.offsets[at + 1]);
    }

    private mark(frame: number, chosen: Contact | null = null): void {
        if (!this.colliding && !this.contacts) return;
        const any = this.bodies.some((_, i) => (this.triangles(i, frame)?.length ?? 0) > 0);
        if (!any && !this.marked) return;
        this.marked = any;
        this.bodies.forEach((b, i) => {
            const own = chosen?.pair.filter((_, side) => chosen.bodies[side] === i) ?? [];
            b.body?.setMarks(b.instance, this.triangles(i, frame) ?? [], own);
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

    /** A ball around all bodies in a frame, without bodies that have fallen far below the ground; null if none is left. */
    private ball(frame: number): Ball | null {
        const { ground } = this.data;
        const balls = this.bodies.map((b, i): Ball | null => {
            const { middle, radius } = b.shape;
            const given = this.positions(i, frame);
            if (given) return ballOfPoints(given);
            const at = new THREE.Vector3(...middle).applyMatrix4(this.matrix(b, frame));
            return ground !== null && at.z < ground - 4 * radius ? null : { middle: at, radius };
        });
        return ballAround(balls.filter((ball) => ball !== null));
    }
}
