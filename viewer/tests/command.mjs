// Runs the `sscc` command of this build and its server.
import { execFile, spawn } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const candidates = [process.env.SSCC_COMMAND, join(root, "target/release/sscc"), join(root, "target/debug/sscc")];

function command() {
    const found = candidates.find((path) => path && existsSync(path));
    if (!found) throw new Error("no sscc command: cargo build, or name it in SSCC_COMMAND");
    return found;
}

/** Runs a command; returns its output. Exit code 1 means collisions, not failure. */
export function run(...args) {
    return new Promise((done, failed) => {
        execFile(command(), args, { maxBuffer: 1 << 30 }, (error, stdout, stderr) => {
            if (error && error.code !== 1) failed(new Error(`sscc ${args.join(" ")}: ${stderr}`));
            else done(stdout);
        });
    });
}

/** Starts `sscc view`; returns its address, its token and a function that stops it. */
export async function view(...args) {
    const child = spawn(command(), ["view", ...args, "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
    const gone = new Promise((done) => child.once("exit", done));
    const lines = createInterface({ input: child.stdout });
    for await (const line of lines) {
        if (!line.startsWith("http://127.0.0.1:")) continue;
        const url = new URL(line.trim());
        return {
            address: url.href,
            origin: url.origin,
            token: url.searchParams.get("token"),
            stop: async () => {
                child.kill();
                await gone;
            },
        };
    }
    throw new Error("sscc view ended without an address");
}

/** Reads the rows of a .npy file of float64 as the demo writes it. */
export function readRows(path) {
    const bytes = readFileSync(path);
    const begin = 10 + bytes.readUInt16LE(8);
    const header = bytes.toString("latin1", 10, begin);
    const [rows, columns] = /'shape': \((\d+), (\d+)\)/.exec(header).slice(1).map(Number);
    if (!header.includes("'<f8'") || header.includes("'fortran_order': True")) throw new Error(header);
    return Array.from({ length: rows }, (_, r) =>
        Array.from({ length: columns }, (_, c) => bytes.readDoubleLE(begin + 8 * (r * columns + c))),
    );
}
