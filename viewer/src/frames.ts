/** The frame loop: runs each task once a frame, then draws the picture if anything changed. */
type Task = (now: number) => boolean;

export class Frames {
    private readonly tasks = new Set<Task>();
    private waiting = false;
    private dirty = false;

    constructor(private readonly draw: () => void) {}

    /** Draws again in the next frame. */
    invalidate(): void {
        this.dirty = true;
        this.wake();
    }

    /** Calls the task in every frame until it returns false. */
    run(task: Task): void {
        this.tasks.add(task);
        this.wake();
    }

    stop(task: Task): void {
        this.tasks.delete(task);
    }

    private wake(): void {
        if (this.waiting) return;
        this.waiting = true;
        requestAnimationFrame((now) => this.frame(now));
    }

    private frame(now: number): void {
        this.waiting = false;
        for (const task of [...this.tasks]) if (!task(now)) this.tasks.delete(task);
        if (this.dirty) {
            this.dirty = false;
            this.draw();
        }
        if (this.tasks.size > 0) this.wake();
    }
}
