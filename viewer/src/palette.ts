/** Tables of 256 colours that are distinct with any kind of colour vision. */

/** Cividis (Nuñez, Anderton, Renslow 2018), from dark blue to yellow, at nine points. */
const CIVIDIS = [
    [0, 34, 78],
    [18, 53, 112],
    [59, 73, 108],
    [87, 93, 109],
    [112, 113, 115],
    [138, 134, 120],
    [165, 156, 116],
    [195, 179, 105],
    [254, 232, 56],
];

/** Entry 255: no value. */
export const NONE = 255;
const NONE_COLOUR = [128, 128, 128];

function between(table: number[][], t: number): number[] {
    const at = Math.min(Math.max(t, 0), 1) * (table.length - 1);
    const i = Math.min(Math.floor(at), table.length - 2);
    return table[i].map((a, c) => Math.round(a + (table[i + 1][c] - a) * (at - i)));
}

function table(colour: (i: number) => number[]): Uint8Array {
    const bytes = new Uint8Array(4 * 256);
    for (let i = 0; i < 256; i++) bytes.set([...(i === NONE ? NONE_COLOUR : colour(i)), 255], 4 * i);
    return bytes;
}

/** Entries 0 to 254: from small to large. */
export const ramp = table((i) => between(CIVIDIS, i / 254));

/** From blue to yellow, bright enough for a dark background. */
const SEARCHED = [
    [52, 98, 166],
    [128, 148, 168],
    [232, 196, 84],
];

/** The colour of nodes that no certificate culls. */
const OPEN = [255, 240, 160];

/** The entry of nodes that no certificate culls. */
export const OPENED = 254;

/** Entries 0 to 253: culled nodes, from the root to the deepest level. */
export const searched = table((i) => (i === OPENED ? OPEN : between(SEARCHED, i / (OPENED - 1))));

const css = (colour: number[]): string => `rgb(${colour.join(" ")})`;
export const openCss = css(OPEN);
export const searchedCss = `linear-gradient(to right, ${SEARCHED.map(css).join(", ")})`;
export const rampCss = `linear-gradient(to right, ${CIVIDIS.map(css).join(", ")})`;
