/** Random directions from the centre. */
import type { Shape } from "./shape";

/** Number of morph targets that a random direction moves, on average. */
const MOVED_TARGETS = 6;

/**
 * Direction `number` of a fixed sequence. Lower modes have larger entries, as in usual motions. A mode whose range
 * begins or ends at its centre, as that of a morph target, moves only into its range, and only a few of many such modes move.
 */
export function randomDirection(shape: Shape, number: number): number[] {
    let state = number * 0x9e3779b9;
    const uniform = (): number => {
        state = (state + 0x6d2b79f5) | 0;
        let t = Math.imul(state ^ (state >>> 15), 1 | state);
        t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
        return (((t ^ (t >>> 14)) >>> 0) + 0.5) / 4294967296;
    };
    const { center, limits, rank } = shape.model;
    return limits.map((limit, k) => {
        const normal = Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());
        if (!shape.isOneSided(k)) return (limit * 0.25 * normal) / (1 + k / 2);
        const [low, high] = shape.range(k);
        const end = high - center[k] > center[k] - low ? high : low;
        return uniform() * rank < MOVED_TARGETS ? uniform() * (end - center[k]) : 0;
    });
}
