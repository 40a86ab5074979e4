/**
 * Copies of vertices such that copy i is the last corner of triangle i, and of no other triangle. "flat" variables have
 * the value of the last corner, so the fragment shader knows its triangle, for about F copies instead of 3F.
 */
export interface Corners {
    /** The vertex of each copy. */
    source: Uint32Array;
    /** Three copies for each triangle, in the orientation of the triangle. */
    index: Uint32Array;
}

export function corners(faces: Uint32Array, vertices: number): Corners {
    const triangles = faces.length / 3;
    const source: number[] = new Array(triangles);
    const copy = new Int32Array(vertices).fill(-1);
    const last = new Uint8Array(triangles);
    for (let t = 0; t < triangles; t++) {
        // Prefers a corner without a copy, so that there are few copies.
        let c = 0;
        for (let k = 2; k >= 0; k--) if (copy[faces[3 * t + k]] < 0) c = k;
        last[t] = c;
        const v = faces[3 * t + c];
        source[t] = v;
        if (copy[v] < 0) copy[v] = t;
    }
    const copyOf = (v: number): number => {
        if (copy[v] < 0) copy[v] = source.push(v) - 1;
        return copy[v];
    };
    const index = new Uint32Array(faces.length);
    for (let t = 0; t < triangles; t++) {
        const c = last[t];
        index[3 * t] = copyOf(faces[3 * t + ((c + 1) % 3)]);
        index[3 * t + 1] = copyOf(faces[3 * t + ((c + 2) % 3)]);
        index[3 * t + 2] = t;
    }
    return { source: Uint32Array.from(source), index };
}
