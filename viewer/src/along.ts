/** Motions along one direction: vibration, and the motion to the first self-collision. */
import type { App } from "./app";
import { digits } from "./dom";
import type { SafeScale } from "./protocol";

/** Longest and shortest period of a displayed vibration (s). */
const MAX_PERIOD = 2.4;
const MIN_PERIOD = 0.7;

export function vibrationName(app: App, mode: number): string {
    return `vibrating ${app.shape.modeName(mode)}`;
}

/**
 * Vibrates a mode about its centre. The amplitude is the displayed distance from the centre, or a default if that is small.
 * A mode whose range begins or ends at its centre, as that of a morph target, moves to one side of the centre only.
 */
export function vibrate(app: App, mode: number): void {
    const name = vibrationName(app, mode);
    const isVibrating = app.motion.name === name;
    app.takeOver();
    if (isVibrating) return;
    const { center, limits, frequencies } = app.shape.model;
    const q = app.pose.q.slice();
    const out = q[mode] - center[mode];
    const isOneSided = app.shape.isOneSided(mode);
    const [low, high] = app.shape.range(mode);
    const usual = isOneSided ? low + high - 2 * center[mode] : limits[mode] * 0.3;
    const amplitude = Math.abs(out) > Math.abs(usual) * 0.01 ? (isOneSided ? out : Math.abs(out)) : usual;
    const known = (frequencies ?? []).filter((f): f is number => f !== null && f > 0);
    const own = frequencies?.[mode] ?? null;
    const ratio = own && known.length > 0 ? own / Math.min(...known) : 1;
    const period = Math.max(MIN_PERIOD, MAX_PERIOD / ratio);
    const path = (t: number): Float64Array => {
        const at = q.slice();
        const phase = (2 * Math.PI * t) / period;
        at[mode] = center[mode] + amplitude * (isOneSided ? 0.5 - 0.5 * Math.cos(phase) : Math.sin(phase));
        return at;
    };
    app.motion.start(name, path, Number.POSITIVE_INFINITY, period);
    if (own)
        app.say(
            `${app.shape.modeName(mode)}: ${app.shape.frequency(mode)}, shown ${digits(own * period, 3)} times slower`,
        );
}

/** Number of searches so far. Only the last one counts; the server cancels the others. */
let searches = 0;

export async function toFirstCollision(app: App, direction: number[], name: string): Promise<void> {
    app.takeOver();
    app.say(`searching for the first self-collision along ${name}…`);
    const search = ++searches;
    const { serial } = app.pose;
    let found: SafeScale;
    try {
        found = await app.source.ask<SafeScale>("/api/safe_scale", { direction });
    } catch (error) {
        if (search !== searches) return;
        throw error;
    }
    if (search !== searches) return;
    const { certified, first, searched, complete } = found;
    const proven = certified === null ? "certified free at every scale" : `certified free up to ${digits(certified)}`;
    if (!first) {
        const end = searched === null ? "" : ` up to ${digits(searched)}`;
        const why = complete ? "" : " (time limit of the search)";
        app.say(`no self-collision along ${name}${end}${why}; ${proven}`);
        return;
    }
    app.say(`first self-collision along ${name} at ${digits(first.scale)}; ${proven}`);
    // If a person has moved the shape meanwhile, it stays as it is.
    if (app.pose.serial !== serial) return;
    const { center } = app.shape.model;
    const seconds = 1.4;
    const path = (t: number): number[] => {
        // The motion slows down towards the collision.
        const s = first.scale * (1 - (1 - Math.min(1, t / seconds)) ** 2);
        return center.map((c, k) => c + s * direction[k]);
    };
    app.motion.start(`${name} to its first self-collision`, path, seconds);
}
