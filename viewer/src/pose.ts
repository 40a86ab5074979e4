/** The displayed q. Each q has a serial; an answer counts only for the q with its serial. */
export class Pose {
    serial = 0;
    private last = 0;
    private readonly listeners: (() => void)[] = [];

    constructor(public q: Float64Array) {}

    onChange(listener: () => void): void {
        this.listeners.push(listener);
    }

    /** Returns the serial for a q that may be displayed later. */
    next(): number {
        return ++this.last;
    }

    show(q: ArrayLike<number>, serial = this.next()): void {
        this.q = Float64Array.from(q);
        this.serial = serial;
        for (const listener of this.listeners) listener();
    }

    change(mode: number, value: number): void {
        const q = this.q.slice();
        q[mode] = value;
        this.show(q);
    }
}
