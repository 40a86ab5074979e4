import { count } from "./dom";

/**
 * Reads a .npy file with rows of `rank` numbers: one or two axes of little-endian float32 or float64, in C or Fortran order. One
 * axis is one row.
 */
export function readNpy(buffer: ArrayBuffer, rank: number): number[][] {
    const bytes = new Uint8Array(buffer);
    if (bytes.length < 12 || String.fromCharCode(...bytes.subarray(1, 6)) !== "NUMPY")
        throw new Error("this is not a .npy file");
    const view = new DataView(buffer);
    const wide = bytes[6] >= 2;
    const length = wide ? view.getUint32(8, true) : view.getUint16(8, true);
    const begin = (wide ? 12 : 10) + length;
    if (begin > bytes.length) throw new Error("the .npy file is truncated");
    const header = new TextDecoder("latin1").decode(bytes.subarray(wide ? 12 : 10, begin));
    const type = /'descr':\s*'([^']*)'/.exec(header)?.[1] ?? "";
    const columnsFirst = /'fortran_order':\s*True/.test(header);
    const shape = (/'shape':\s*\(([^)]*)\)/.exec(header)?.[1] ?? "")
        .split(",")
        .filter((s) => s.trim() !== "")
        .map(Number);
    if (type !== "<f8" && type !== "<f4")
        throw new Error(`the .npy file has the type '${type.slice(0, 10)}': save it as float64 or float32`);
    if (shape.length < 1 || shape.length > 2) throw new Error(`the .npy file has ${shape.length} axes, not 1 or 2`);
    const [rows, columns] = shape.length === 2 ? shape : [1, shape[0]];
    const size = type === "<f8" ? 8 : 4;
    if (bytes.length - begin !== rows * columns * size) throw new Error("the .npy file is truncated or too long");
    // The size of the file does not bound the number of rows without numbers.
    if (columns !== rank)
        throw new Error(
            `each row of the .npy file has ${count(columns, "number")}, the model has ${count(rank, "mode")}`,
        );
    const value = (i: number): number =>
        size === 8 ? view.getFloat64(begin + 8 * i, true) : view.getFloat32(begin + 4 * i, true);
    return Array.from({ length: rows }, (_, r) =>
        Array.from({ length: columns }, (_, c) => value(columnsFirst ? c * rows + r : r * columns + c)),
    );
}
