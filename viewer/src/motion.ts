/**
 * Motions of q. Each q is displayed together with its answer, so the gauge and the picture agree; without an answer if that takes
 * too long.
 */
import type { Checker } from "./checker";
import type { Frames } from "./frames";
import type { Pose } from "./pose";

/** Longest time that a motion waits for an answer before it proposes its next q (ms). */
const MAX_WAIT = 250;

export class Motion {
    /** Name of the motion; null at rest. */
    name: string | null = null;
    /** q over time, for export. */
    track: { q: number[][]; times: number[] } | null = null;
    private run = 0;
    private waitingSince: number | null = null;
    private readonly listeners: (() => void)[] = [];

    constructor(
        private readonly frames: Frames,
        private readonly pose: Pose,
        private readonly checker: Checker | null,
    ) {}

    onChange(listener: () => void): void {
        this.listeners.push(listener);
    }

    /** Ends the motion; a q that was proposed before is not displayed any more. */
    stop(): void {
        this.run++;
        this.name = null;
        this.waitingSince = null;
        for (const listener of this.listeners) listener();
    }

    /**
     * Moves q along `path` (seconds -> q) for `seconds`, which may be infinite. The export has the first `period`
     * seconds.
     */
    start(name: string, path: (seconds: number) => ArrayLike<number>, seconds: number, period = seconds): void {
        this.stop();
        this.name = name;
        const times = Array.from({ length: 61 }, (_, i) => (period * i) / 60);
        this.track = { times, q: times.map((t) => Array.from(path(t))) };
        const run = this.run;
        let begin: number | null = null;
        this.frames.run((now) => {
            if (run !== this.run) return false;
            begin ??= now;
            if (this.waitingSince !== null && now - this.waitingSince < MAX_WAIT) return true;
            const t = Math.min((now - begin) / 1000, seconds);
            this.propose(path(t), now);
            if (t < seconds) return true;
            this.name = null;
            for (const listener of this.listeners) listener();
            return false;
        });
        for (const listener of this.listeners) listener();
    }

    /** Displays q when its answer arrives or a later q replaces it; at once if the page cannot check q. */
    propose(q: ArrayLike<number>, now = performance.now()): void {
        const { run } = this;
        const serial = this.pose.next();
        if (!this.checker) {
            this.pose.show(q, serial);
            return;
        }
        this.waitingSince = now;
        void this.checker.check(Float64Array.from(q), serial).then(() => {
            this.waitingSince = null;
            if (run === this.run && serial > this.pose.serial) this.pose.show(q, serial);
        });
    }
}
