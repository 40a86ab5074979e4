/** The state that all parts of the page share. */
import type { Body } from "./body";
import type { Checker } from "./checker";
import type { Frames } from "./frames";
import type { Motion } from "./motion";
import type { Pose } from "./pose";
import type { Scene } from "./protocol";
import type { Shape } from "./shape";
import type { Source } from "./source";
import type { Stage } from "./stage";

export interface RecordedFrame {
    /** Number of colliding pairs; null if unknown. */
    pairs: number | null;
    /** The largest number of colliding pairs in one step between the previous frame and this one. */
    since: number;
    /** The pairs that were not tested: ", apart from ...", or nothing. */
    apart: string;
    /**
     * The earliest time of impact (0 to 1) in a frame of a continuous check, null without pairs; undefined in other recordings.
     * The pairs of a continuous check are those of the step to the next frame.
     */
    impact?: number | null | undefined;
    /** Whether it is the last frame of a continuous check: no step follows. */
    isEnd?: boolean;
}

export interface App {
    readonly source: Source;
    readonly scene: Scene;
    readonly frames: Frames;
    readonly shape: Shape;
    readonly pose: Pose;
    readonly motion: Motion;
    /** Null in a report that cannot check q. */
    readonly checker: Checker | null;
    /** Null where WebGL is missing. */
    readonly stage: Stage | null;
    /** The shape that the modes move; null without a stage, and while a recording is displayed that has bodies of its own. */
    body: Body | null;
    /** The pair chosen in the list of collisions. */
    chosen: [number, number] | null;
    /** The displayed frame of a recording. */
    recorded: RecordedFrame | null;
    /** Updates the marks of colliding triangles. */
    refreshMarks(): void;
    /** Ends the motion and pauses the timeline, so that the q that a person chooses stays. */
    takeOver(): void;
    /** Plays q row by row. */
    playRows(rows: number[][]): void;
    /** Shows a line: a result, or an error. */
    say(message: string, wrong?: boolean): void;
}

/** Runs an action that a person started, and shows its error in one line. */
export async function attempt(app: App, work: () => Promise<void>): Promise<void> {
    try {
        await work();
    } catch (error) {
        app.say((error as Error).message, true);
    }
}
