/** Requests checks of q from the server: at most one check is in flight, and only the latest q waits. */
import type { Answer } from "./protocol";
import type { Source } from "./source";

interface CheckRequest {
    q: Float64Array;
    serial: number;
    settle: (answer: Answer | null) => void;
}

export class Checker {
    /** The last answer; it holds only for the q with its serial. */
    answer: Answer | null = null;
    error: string | null = null;
    /** Whether answers list the opened and culled nodes. */
    nodes = false;
    /** The serial of the last request. */
    lastSerial = -1;
    private isInFlight = false;
    private waiting: CheckRequest | null = null;
    private readonly listeners: (() => void)[] = [];

    constructor(private readonly source: Source) {}

    onAnswer(listener: () => void): void {
        this.listeners.push(listener);
    }

    /** The answer; null if a later q replaced this one, or there was no answer. */
    check(q: Float64Array, serial: number): Promise<Answer | null> {
        this.waiting?.settle(null);
        this.lastSerial = serial;
        return new Promise((settle) => {
            this.waiting = { q, serial, settle };
            void this.send();
        });
    }

    private async send(): Promise<void> {
        if (this.isInFlight || !this.waiting) return;
        const { q, serial, settle } = this.waiting;
        this.waiting = null;
        this.isInFlight = true;
        let answer: Answer | null = null;
        try {
            answer = await this.source.ask<Answer>("/api/check", { q: [...q], serial, nodes: this.nodes });
            this.answer = answer;
            this.error = null;
        } catch (error) {
            this.error = (error as Error).message;
        }
        this.isInFlight = false;
        settle(answer);
        for (const listener of this.listeners) listener();
        void this.send();
    }
}
