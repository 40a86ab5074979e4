/** Answers of a report that has the core of sscc within it, as WebAssembly (docs/wasm.md): the same queries as the program's. */
import type { Answer, ChecksData } from "./protocol";

/** As many pairs as the server finds and lists (docs/view.md). */
const MAX_PAIRS = 100_000;
const MAX_LISTED_PAIRS = 10_000;
/** A query is repeated for this time (ms), because the clocks of browsers are coarse. */
const MEASURED_TIME = 1;

/** The part of the package that checks need: crates/sscc-wasm. */
interface Statistics {
    norm: number;
    rootCertified: boolean;
    proof: Answer["proof"];
    complete: boolean;
    opened: number;
    boxTests: number;
    triangleTests: number;
    free(): void;
}

interface Query {
    discreteAtMost(q: Float64Array, limit: number): Uint32Array;
    readonly statistics: Statistics;
}

interface Certificates {
    readonly rootRadius: number;
}

interface Package {
    (options: { module_or_path: BufferSource }): Promise<unknown>;
    Model: { load(bytes: Uint8Array): object };
    Certificates: { load(bytes: Uint8Array): Certificates };
    Query: new (model: object, certificates: Certificates) => Query;
}

/** The package, which its script declares. */
declare const ssccPackage: Package;

async function inflate(bytes: ArrayBuffer): Promise<ArrayBuffer> {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(stream).arrayBuffer();
}

export class LocalChecks {
    private constructor(
        private readonly query: Query,
        private readonly certificates: Certificates,
    ) {}

    static async open(data: ChecksData, array: (name: string) => Promise<ArrayBuffer>): Promise<LocalChecks> {
        // The script may have run before an error; it may run only once.
        if (typeof ssccPackage === "undefined") {
            const script = document.createElement("script");
            script.textContent = data.script;
            document.head.append(script);
        }
        await ssccPackage({ module_or_path: await inflate(await array(data.module)) });
        const [model, certificates] = await Promise.all(
            [data.model, data.certificates].map(async (name) => new Uint8Array(await inflate(await array(name)))),
        );
        const loaded = ssccPackage.Certificates.load(certificates);
        return new LocalChecks(new ssccPackage.Query(ssccPackage.Model.load(model), loaded), loaded);
    }

    /** The answer that `/api/check` of the server gives, without nodes. */
    check(q: number[], serial: number): Answer {
        const at = Float64Array.from(q);
        const start = performance.now();
        let found = this.query.discreteAtMost(at, MAX_PAIRS);
        let runs = 1;
        for (; performance.now() - start < MEASURED_TIME; runs++) found = this.query.discreteAtMost(at, MAX_PAIRS);
        const passed = performance.now() - start;
        const { statistics } = this.query;
        const { norm, rootCertified, proof, complete, opened, boxTests, triangleTests } = statistics;
        statistics.free();
        const count = found.length / 2;
        const pairs = Array.from({ length: Math.min(count, MAX_LISTED_PAIRS) }, (_, i): [number, number] => [
            found[2 * i],
            found[2 * i + 1],
        ]);
        const { rootRadius } = this.certificates;
        return {
            serial,
            norm,
            colliding: count > 0,
            count,
            complete,
            pairs,
            triangles: [...new Set(found)].sort((a, b) => a - b),
            microseconds: (1000 * passed) / runs,
            root_certified: rootCertified,
            proof,
            opened,
            box_tests: boxTests,
            triangle_tests: triangleTests,
            root_share: rootRadius > 0 ? norm / rootRadius : null,
        };
    }
}
