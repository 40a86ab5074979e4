/**
 * The view of a recording: it frames the bodies, not the space through which they fly. The view follows them where they leave
 * its middle, and stays where they only deform.
 */
import * as THREE from "three";

/** A ball around the bodies in one frame. */
export interface Ball {
    middle: THREE.Vector3;
    radius: number;
}

/** Number of frames that determine the size of the view. */
const SAMPLES = 24;
/** Balls larger than this multiple of the median do not count: bodies that scatter would make the view too large. */
const LARGEST = 2;
/** The view follows the bodies when their middle is farther than this from the middle of the view, as a share of its radius. */
const SLACK = 0.3;

export class Framing {
    readonly radius: number;
    /** The diagonal of the AABB of all middles, and its middle. */
    readonly flight: { length: number; middle: THREE.Vector3 };
    private readonly at: THREE.Vector3;

    /** `ball` returns a ball around the bodies in a frame; null if there are none. */
    constructor(
        frames: number,
        private readonly ball: (frame: number) => Ball | null,
    ) {
        const step = Math.max(1, (frames - 1) / SAMPLES);
        const balls: Ball[] = [];
        for (let frame = 0; frame < frames; frame += step) {
            const found = ball(Math.round(frame));
            if (found) balls.push(found);
        }
        const radii = balls.map((b) => b.radius).sort((a, b) => a - b);
        const median = radii[radii.length >> 1] ?? 0;
        this.radius = Math.max(0, ...radii.filter((radius) => radius <= LARGEST * median)) || 1;
        this.at = balls[0]?.middle.clone() ?? new THREE.Vector3();
        const box = new THREE.Box3().setFromPoints(balls.map((b) => b.middle));
        this.flight = { length: 0, middle: this.at.clone() };
        if (box.isEmpty()) return;
        this.flight.length = box.getSize(new THREE.Vector3()).length();
        box.getCenter(this.flight.middle);
    }

    /** The middle of the view. */
    get middle(): [number, number, number] {
        return this.at.toArray();
    }

    /** Moves the middle of the view to a frame; returns its displacement, null for none. */
    follow(frame: number): [number, number, number] | null {
        const ball = this.ball(frame);
        if (!ball) return null;
        const way = ball.middle.clone().sub(this.at);
        const excess = way.length() - SLACK * this.radius;
        if (excess <= 0) return null;
        way.setLength(excess);
        this.at.add(way);
        return way.toArray();
    }
}

/** A ball around balls. */
export function ballAround(balls: Ball[]): Ball | null {
    if (balls.length === 0) return null;
    const box = new THREE.Box3();
    for (const { middle, radius } of balls) {
        box.expandByPoint(middle.clone().addScalar(radius));
        box.expandByPoint(middle.clone().addScalar(-radius));
    }
    const middle = box.getCenter(new THREE.Vector3());
    return { middle, radius: Math.max(...balls.map((b) => b.radius + b.middle.distanceTo(middle))) };
}

/** A ball around points. */
export function ballOfPoints(positions: Float32Array): Ball {
    const box = new THREE.Box3();
    const point = new THREE.Vector3();
    for (let i = 0; i < positions.length; i += 3) box.expandByPoint(point.fromArray(positions, i));
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    return { middle: sphere.center, radius: Math.max(0, sphere.radius) };
}
