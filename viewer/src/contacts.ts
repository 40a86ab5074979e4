/** The colliding pairs and the contact curves of the frames of a recording. */
import type { PlaybackData } from "./protocol";
import type { Source } from "./source";

export interface Contact {
    /** The body of each triangle. */
    bodies: [number, number];
    pair: [number, number];
    /** Time of impact in the step after the frame, from 0 to 1; null if the frame is checked by itself. */
    time: number | null;
}

export class Contacts {
    private constructor(
        private readonly bodies: number,
        private readonly offsets: Uint32Array,
        private readonly pairs: Uint32Array,
        private readonly times: Float32Array | null,
        private readonly seconds: Uint32Array | null,
        readonly isBetween: boolean,
        private readonly curveOffsets: Uint32Array,
        private readonly segments: Float32Array,
    ) {}

    /** Null if the recording has no pairs. */
    static async load(source: Source, data: PlaybackData): Promise<Contacts | null> {
        const { contacts, curves } = data;
        if (!contacts) return null;
        const none = new ArrayBuffer(0);
        const [offsets, pairs, times, seconds, curveOffsets, segments] = await Promise.all([
            source.array(contacts.offsets),
            source.array(contacts.pairs),
            contacts.times === null ? null : source.array(contacts.times),
            contacts.seconds ? source.array(contacts.seconds) : null,
            curves ? source.array(curves.offsets) : none,
            curves ? source.array(curves.segments) : none,
        ]);
        return new Contacts(
            data.bodies.length,
            new Uint32Array(offsets),
            new Uint32Array(pairs),
            times && new Float32Array(times),
            seconds && new Uint32Array(seconds),
            contacts.is_between,
            new Uint32Array(curveOffsets),
            new Float32Array(segments),
        );
    }

    get isContinuous(): boolean {
        return this.times !== null;
    }

    of(frame: number): Contact[] {
        const found: Contact[] = [];
        for (let body = 0; body < this.bodies; body++) {
            const [from, to] = this.range(frame, body);
            for (let i = from; i < to; i++)
                found.push({
                    bodies: [body, this.second(i, body)],
                    pair: [this.pairs[2 * i], this.pairs[2 * i + 1]],
                    time: this.times?.[i] ?? null,
                });
        }
        return found;
    }

    /** The earliest time of impact; null without pairs, undefined if frames are checked by themselves. */
    impact(frame: number): number | null | undefined {
        if (!this.times) return undefined;
        const [from, to] = [this.range(frame, 0)[0], this.range(frame, this.bodies - 1)[1]];
        return from === to ? null : this.times.subarray(from, to).reduce((a, b) => Math.min(a, b));
    }

    /** The colliding triangles of a body; a triangle of several pairs occurs several times. */
    triangles(frame: number, body: number): Uint32Array {
        if (!this.isBetween && !this.seconds) {
            const [from, to] = this.range(frame, body);
            return this.pairs.subarray(2 * from, 2 * to);
        }
        const found: number[] = [];
        for (const { bodies, pair } of this.of(frame)) found.push(...pair.filter((_, side) => bodies[side] === body));
        return Uint32Array.from(found);
    }

    /** The body of the second triangle of a pair of a body's list. */
    private second(pair: number, body: number): number {
        return this.seconds ? this.seconds[pair] : this.isBetween ? 1 : body;
    }

    /** Segments of two points each. */
    curves(frame: number): Float32Array {
        return this.segments.subarray(6 * this.curveOffsets[frame], 6 * this.curveOffsets[frame + 1]);
    }

    private range(frame: number, body: number): [number, number] {
        const at = frame * this.bodies + body;
        return [this.offsets[at], this.offsets[at + 1]];
    }
}
