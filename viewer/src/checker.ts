/** Asks the native core about q: one check in flight at most, and of those waiting only the latest. */
import type { Answer } from "./protocol";
import type { Source } from "./source";

interface Wanted {
    q: Float64Array;
    serial: number;
    settle: (answer: Answer | null) => void;
}

export class Checker {
    /** The last answer; it speaks of the q with its serial only. */
    answer: Answer | null = null;
    error: string | null = null;
    /** Whether answers are to list the nodes that were opened and culled. */
    nodes = false;
    /** The serial asked for last. */
    asked = -1;
    private flying = false;
    private wanted: Wanted | null = null;
    private readonly listeners: (() => void)[] = [];

    constructor(private readonly source: Source) {}

    onAnswer(listener: () => void): void {
        this.listeners.push(listener);
    }

    /** Null where a later q took its place, or no answer came. */
    check(q: Float64Array, serial: number): Promise<Answer | null> {
        this.wanted?.settle(null);
        this.asked = serial;
        return new Promise((settle) => {
            this.wanted = { q, serial, settle };
            void this.fly();
        });
    }

    private async fly(): Promise<void> {
        if (this.flying || !this.wanted) return;
        const { q, serial, settle } = this.wanted;
        this.wanted = null;
        this.flying = true;
        let answer: Answer | null = null;
        try {
            answer = await this.source.ask<Answer>("/api/check", { q: [...q], serial, nodes: this.nodes });
            this.answer = answer;
            this.error = null;
        } catch (error) {
            this.error = (error as Error).message;
        }
        this.flying = false;
        settle(answer);
        for (const listener of this.listeners) listener();
        void this.fly();
    }
}
