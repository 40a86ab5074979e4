/** Switches between the shape of the sliders and the recording. */
import type { App } from "./app";
import { h } from "./dom";
import type { MovingBody } from "./glb";
import type { Layout } from "./layout";
import { Playback } from "./playback";
import { Shape } from "./shape";
import { Timeline, type Track } from "./timeline";

/** Frame rate of loaded rows of q, which have no times. */
const ROWS_PER_SECOND = 30;

export class Player {
    timeline: Timeline | null = null;
    private recorded: Playback | null = null;
    /** The frames of the recording. */
    private recording: Track | null = null;
    /** Whether the shape of the sliders is displayed, not the recording. */
    private exploring = true;
    /** Whether the recording itself changes q. */
    private showing = false;
    private up: "y" | "z" = "y";
    private readonly listeners: ((time: number | null) => void)[] = [];
    private readonly modeButton: HTMLButtonElement;

    constructor(
        private readonly app: App,
        private readonly layout: Layout,
    ) {
        this.modeButton = h(
            "button",
            { type: "button", class: "back", hidden: true, onclick: () => this.enterPlayback() },
            "back to the recording",
        );
    }

    onFrame(listener: (time: number | null) => void): void {
        this.listeners.push(listener);
    }

    /** Shows the recording, if there is one, else the shape. */
    async begin(): Promise<void> {
        const { app } = this;
        this.standAlone();
        app.pose.show(app.pose.q);
        const data = app.scene.playback;
        if (!data || data.times.length === 0 || data.bodies.length === 0) return;
        const models = app.scene.models;
        const shapeOf = (model: number): Promise<Shape> =>
            model === 0 ? Promise.resolve(app.shape) : Shape.load(app.source, models[model]);
        this.recorded = await Playback.load(app, app.source, data, shapeOf);
        const sound =
            data.sound === null ? null : new Blob([await app.source.array(data.sound)], { type: "audio/wav" });
        const { pairs, since } = this.recorded;
        const { clock, contacts } = data;
        const contact = contacts?.is_between || contacts?.seconds ? "contact" : "self-contact";
        const show = (frame: number): void => this.show(frame);
        this.recording = { times: data.times, pairs, since, sound, clock, contact, show };
        this.open(this.recording);
        this.enterPlayback();
    }

    /** Plays loaded rows of q in place of the recording. */
    playRows(rows: number[][]): void {
        const { app } = this;
        this.leave();
        const times = rows.map((_, i) => i / ROWS_PER_SECOND);
        app.motion.track = { q: rows, times };
        const show = (frame: number): void => {
            this.endMotion();
            app.motion.propose(rows[frame]);
        };
        this.open({ times, pairs: null, since: null, sound: null, show });
        this.timeline?.seek(0);
        this.timeline?.start();
    }

    /** The recording, if it is displayed and has the positions of meshes. */
    get meshes(): Playback | null {
        return !this.exploring && this.recorded?.given ? this.recorded : null;
    }

    /** The recording while it is displayed; else null. */
    get shown(): { bodies: MovingBody[]; times: number[] } | null {
        if (this.exploring || !this.recorded) return null;
        return { bodies: this.recorded.moving, times: this.recorded.data.times };
    }

    step(by: number): void {
        if (!this.timeline) return;
        this.timeline.pause();
        this.timeline.seek(this.timeline.frame + by);
    }

    /** Leaves the recording after a change of q, unless the recording itself changed q. */
    explore(): void {
        if (this.showing || this.exploring) return;
        if (!this.recorded?.posed) {
            this.leave();
            return;
        }
        this.app.recorded = null;
        if (!this.app.checker) this.app.body?.setMarks(0, []);
    }

    turnUp(): void {
        this.up = this.up === "y" ? "z" : "y";
        const { stage, shape } = this.app;
        if (this.exploring) stage?.frame(shape.middle, shape.radius, this.up);
        else this.meshes?.look(this.up);
    }

    /** Replaces the recording by the shape of the sliders. */
    private leave(): void {
        if (this.exploring) return;
        this.timeline?.pause();
        this.exploring = true;
        this.app.recorded = null;
        this.modeButton.hidden = false;
        for (const listener of this.listeners) listener(null);
        if (!this.recorded?.posed) this.standAlone();
        else if (!this.app.checker) this.app.body?.setMarks(0, []);
    }

    private open(track: Track): void {
        this.timeline?.close();
        this.timeline = new Timeline(this.app.frames, track);
        this.timeline.onFrame((_, time) => {
            // Times of rows are not those of the plots.
            for (const listener of this.listeners) listener(track === this.recording ? time : null);
        });
        this.timeline.element.append(this.modeButton);
        this.timeline.element.hidden = track.times.length < 2;
        this.layout.below.append(this.timeline.element);
    }

    private standAlone(): void {
        const { app } = this;
        const { stage, shape } = app;
        if (!stage) return;
        stage.removeBodies();
        stage.setGround(null);
        app.body = stage.addBody(shape, 1);
        app.body.setQ(0, app.pose.q);
        stage.frame(shape.middle, shape.radius, this.up);
    }

    private enterPlayback(): void {
        if (!this.recorded || !this.recording) return;
        if (this.timeline?.track !== this.recording) this.open(this.recording);
        this.exploring = false;
        this.modeButton.hidden = true;
        this.app.motion.stop();
        if (!this.recorded.posed) {
            this.app.body = null;
            this.recorded.enter(this.up);
        }
        this.show(this.timeline!.frame);
    }

    /** Ends a motion along modes, which would replace the frames of the timeline. */
    private endMotion(): void {
        if (this.app.motion.name !== null) this.app.motion.stop();
    }

    private show(frame: number): void {
        if (this.exploring) this.enterPlayback();
        this.endMotion();
        this.showing = true;
        this.recorded?.show(frame);
        this.showing = false;
    }
}
