/** What the parts of the page share. */
import type { Body } from "./body";
import type { Checker } from "./checker";
import type { Frames } from "./frames";
import type { Motion } from "./motion";
import type { Pose } from "./pose";
import type { Scene } from "./protocol";
import type { Shape } from "./shape";
import type { Source } from "./source";
import type { Stage } from "./stage";

export interface App {
    readonly source: Source;
    readonly scene: Scene;
    readonly frames: Frames;
    readonly shape: Shape;
    readonly pose: Pose;
    readonly motion: Motion;
    /** Null in a report. */
    readonly checker: Checker | null;
    /** Null where WebGL is missing. */
    readonly stage: Stage | null;
    /** The shape that the modes move; null while several bodies play, or without a stage. */
    body: Body | null;
    /** The pair looked at. */
    chosen: [number, number] | null;
    /**
     * What a recording says of the frame shown: its colliding pairs of triangles, null where they are not known; and
     * the most of them in one step since the frame before.
     */
    recorded: { pairs: number | null; since: number } | null;
    /** Paints the colliding triangles again. */
    refreshMarks(): void;
    /** Plays q row by row. */
    playRows(rows: number[][]): void;
    /** One line for people: what went wrong, or what came out. */
    say(message: string, wrong?: boolean): void;
}

/** Runs what a person asked for; what goes wrong is told in one line. */
export async function attempt(app: App, work: () => Promise<void>): Promise<void> {
    try {
        await work();
    } catch (error) {
        app.say((error as Error).message, true);
    }
}
