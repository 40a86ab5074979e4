/** The timeline: plays frames by a clock, in sync with the sound; marks show contacts. */

import { count, digits, h, svg } from "./dom";
import type { Frames } from "./frames";

const SPEEDS = [2, 1, 0.5, 0.25, 0.1, 0.02];
/** The initial speed makes a motion without sound last at least this time (s), if one of `SPEEDS` does. */
const MIN_DURATION = 3;

export interface Track {
    times: number[];
    /** Colliding pairs of each frame; null if unknown. */
    pairs: number[] | null;
    /** The largest number of pairs in one step between the previous frame and each frame; null without such steps. */
    since: number[] | null;
    /** How a frame is named: by its time, if undefined. */
    clock?: "time" | "frame" | "frame_and_time" | undefined;
    /** The word for contacts; "self-contact" if undefined. */
    contact?: string;
    show(frame: number): void;
    sound: Blob | null;
}

export class Timeline {
    readonly element: HTMLElement;
    frame = 0;
    playing = false;
    private readonly play: HTMLButtonElement;
    private readonly slider: HTMLInputElement;
    private readonly clock = h("output", { class: "clock" });
    private readonly speed: HTMLSelectElement;
    private readonly audio: HTMLAudioElement | null;
    private readonly listeners: ((frame: number, time: number) => void)[] = [];
    private time: number;
    private last: number | null = null;

    constructor(
        private readonly frames: Frames,
        readonly track: Track,
    ) {
        const { times } = track;
        this.time = times[0] ?? 0;
        const length = (times.at(-1) ?? 0) - this.time;
        const first = track.sound ? 1 : (SPEEDS.find((s) => s <= 1 && length / s >= MIN_DURATION) ?? SPEEDS.at(-1)!);
        this.audio = track.sound ? h("audio", { src: URL.createObjectURL(track.sound), preload: "auto" }) : null;
        this.play = h("button", { type: "button", class: "play", onclick: () => this.toggle() }, "▶");
        this.slider = h("input", {
            type: "range",
            min: 0,
            max: Math.max(0, times.length - 1),
            step: 1,
            value: 0,
            "aria-label": "frame",
            oninput: () => this.seek(this.slider.valueAsNumber),
        });
        this.speed = h(
            "select",
            { "aria-label": "speed", onchange: () => this.respeed() },
            ...SPEEDS.map((s) =>
                h("option", { value: s, selected: s === first }, s >= 1 ? `${s}×` : `1/${Math.round(1 / s)}×`),
            ),
        );
        const contact = times.some((_, frame) => this.touches(frame));
        const noun = track.contact ?? "self-contact";
        const jump = (step: number): HTMLButtonElement =>
            h(
                "button",
                {
                    type: "button",
                    class: "small",
                    "aria-label": `${step > 0 ? "next" : "previous"} ${noun}`,
                    title: `${step > 0 ? "next" : "previous"} ${noun}`,
                    onclick: () => this.jump(step),
                },
                step > 0 ? "▲›" : "‹▲",
            );
        const mute = h(
            "button",
            { type: "button", class: "small", "aria-pressed": "false", onclick: () => this.mute(mute) },
            "sound on",
        );
        this.element = h(
            "section",
            { class: "timeline", "aria-label": "playback" },
            this.play,
            contact && jump(-1),
            contact && jump(1),
            h("div", { class: "line" }, this.marks(), this.slider),
            this.clock,
            this.speed,
            this.audio && mute,
            this.audio,
        );
        this.update();
    }

    onFrame(listener: (frame: number, time: number) => void): void {
        this.listeners.push(listener);
    }

    toggle(): void {
        if (this.playing) this.pause();
        else this.start();
    }

    start(): void {
        if (this.playing || this.track.times.length < 2) return;
        if (this.frame >= this.track.times.length - 1) this.seek(0);
        this.playing = true;
        this.last = null;
        if (this.audio) {
            this.respeed();
            this.audio.currentTime = Math.max(0, this.time - this.track.times[0]);
            // If the browser blocks the sound, the picture plays without it.
            void this.audio.play().catch(() => undefined);
        }
        this.frames.run((now) => this.tick(now));
        this.update();
    }

    pause(): void {
        this.playing = false;
        this.audio?.pause();
        this.update();
    }

    seek(frame: number): void {
        this.frame = Math.min(Math.max(0, Math.round(frame)), this.track.times.length - 1);
        this.time = this.track.times[this.frame];
        if (this.audio) this.audio.currentTime = Math.max(0, this.time - this.track.times[0]);
        this.show();
    }

    close(): void {
        this.pause();
        if (this.audio) URL.revokeObjectURL(this.audio.src);
        this.element.remove();
    }

    /** Whether triangles collide in a frame, or in a step since the previous frame. */
    private touches(frame: number): boolean {
        const { pairs, since } = this.track;
        return (pairs?.[frame] ?? 0) > 0 || (since?.[frame] ?? 0) > 0;
    }

    /** Seeks the next start of a contact, or the previous one if `step` is -1. */
    private jump(step: number): void {
        for (let f = this.frame + step; f >= 0 && f < this.track.times.length; f += step) {
            if (this.touches(f) && !this.touches(f - 1)) {
                this.seek(f);
                return;
            }
        }
    }

    private tick(now: number): boolean {
        if (!this.playing) return false;
        const { times } = this.track;
        if (this.audio && !this.audio.paused) this.time = times[0] + this.audio.currentTime;
        else if (this.last !== null) this.time += ((now - this.last) / 1000) * Number(this.speed.value);
        this.last = now;
        let frame = this.frame;
        while (frame + 1 < times.length && times[frame + 1] <= this.time) frame++;
        if (frame !== this.frame) {
            this.frame = frame;
            this.show();
        }
        const ended = this.audio
            ? this.audio.ended || this.time >= times[times.length - 1]
            : frame === times.length - 1;
        if (ended && frame === times.length - 1) this.pause();
        return this.playing;
    }

    private show(): void {
        this.track.show(this.frame);
        this.update();
        for (const listener of this.listeners) listener(this.frame, this.track.times[this.frame]);
    }

    private update(): void {
        const { times, pairs, since } = this.track;
        this.play.textContent = this.playing ? "❚❚" : "▶";
        this.play.setAttribute("aria-label", this.playing ? "pause" : "play");
        this.slider.value = String(this.frame);
        const touching = pairs && pairs[this.frame] > 0 ? `, ${count(pairs[this.frame], "colliding pair")}` : "";
        const touched = since && since[this.frame] > 0 ? ", collided between frames" : "";
        const clock = this.track.clock ?? "time";
        const [number, seconds] = [clock !== "time", clock !== "frame"];
        const name = number ? `frame ${this.frame}` : "";
        const between = number && seconds ? ", " : "";
        const spoken = `${name}${between}${seconds ? `${digits(times[this.frame], 3)} seconds` : ""}`;
        this.slider.setAttribute("aria-valuetext", `${spoken}${touching}${touched}`);
        this.clock.textContent = `${name}${between}${seconds ? `${times[this.frame].toFixed(3)} s` : ""}`;
    }

    private respeed(): void {
        if (this.audio) this.audio.playbackRate = Number(this.speed.value);
    }

    private mute(button: HTMLButtonElement): void {
        if (!this.audio) return;
        this.audio.muted = !this.audio.muted;
        button.textContent = this.audio.muted ? "sound off" : "sound on";
        button.setAttribute("aria-pressed", String(this.audio.muted));
    }

    /**
     * At most 300 bars: at frames with colliding pairs, higher for more pairs, and low bars for collisions only between
     * two frames.
     */
    private marks(): SVGElement {
        const { pairs, since, times } = this.track;
        const columns = Math.min(300, times.length);
        const root = svg("svg", {
            class: "marks",
            viewBox: "0 0 300 20",
            preserveAspectRatio: "none",
            "aria-hidden": "true",
        });
        const most = Math.log1p((pairs ?? []).reduce((a, b) => Math.max(a, b), 1));
        const largest = (of: number[] | null, from: number, to: number): number =>
            (of ?? []).slice(from, to).reduce((a, b) => Math.max(a, b), 0);
        for (let c = 0; c < columns; c++) {
            const from = Math.floor((c * times.length) / columns);
            const to = Math.max(from + 1, Math.floor(((c + 1) * times.length) / columns));
            const height = largest(pairs, from, to);
            if (height === 0 && largest(since, from, to) === 0) continue;
            const tall = height > 0 ? 8 + (12 * Math.log1p(height)) / most : 4;
            root.append(
                svg("rect", {
                    x: (300 * c) / columns,
                    width: 300 / columns + 0.3,
                    y: 20 - tall,
                    height: tall,
                    class: height > 0 ? "contact" : "contact since",
                }),
            );
        }
        return root;
    }
}
