// The five models of `cargo xtask digests`: certificates and answers must have the bytes of the native ones.

/** The bytes of numbers, little-endian, in the order of `docs/records/digests.txt`. */
class Bytes {
    #bytes = [];
    u32(values) {
        this.#bytes.push(...new Uint8Array(Uint32Array.from(values).buffer));
    }
    f64(value) {
        this.#bytes.push(...new Uint8Array(Float64Array.of(value).buffer));
    }
    all() {
        return Uint8Array.from(this.#bytes);
    }
}

/** Where two arrays of bytes differ first; null where they are equal. */
function difference(a, b) {
    if (a.length !== b.length) return `${a.length} and ${b.length} bytes`;
    const at = a.findIndex((byte, i) => byte !== b[i]);
    return at < 0 ? null : `byte ${at} of ${a.length}`;
}

/** Whether a batch of all q of a motion has the pairs of each. */
function batchDiffers({ Query }, model, certificates, motion) {
    const query = new Query(model, certificates);
    const batch = query.batch(Float64Array.from(motion.flat()));
    const [pairs, offsets] = [batch.pairs, batch.offsets];
    const differs = motion.some((row, i) => {
        const own = pairs.subarray(2 * offsets[i], 2 * offsets[i + 1]);
        return difference(own, query.discrete(Float64Array.from(row))) !== null;
    });
    const count = batch.count;
    for (const object of [query, batch]) object.free();
    return differs || count !== motion.length;
}

/** All answers of a motion. */
function answers({ Query }, model, certificates, motion) {
    const query = new Query(model, certificates);
    const bytes = new Bytes();
    let before = new Float64Array(model.rank);
    for (const row of motion) {
        const q = Float64Array.from(row);
        bytes.u32(query.discrete(q));
        bytes.f64(query.safeScale(q));
        const impacts = query.continuous(before, q);
        const [pairs, times] = [impacts.pairs, impacts.times];
        for (let i = 0; i < impacts.count; i++) {
            bytes.u32(pairs.subarray(2 * i, 2 * i + 2));
            bytes.f64(times[i]);
        }
        impacts.free();
        before = q;
    }
    query.free();
    return bytes.all();
}

/**
 * Lists what differs from the native bytes. `read` returns the bytes of a file that the example `digests` wrote.
 * @returns {Promise<{models: number, differences: string[]}>}
 */
export async function compare(sscc, read) {
    const models = JSON.parse(new TextDecoder().decode(await read("models.json")));
    const differences = [];
    for (const { name, neighbours, weld, motion } of models) {
        const file = await read(`${name}.model`);
        const model = sscc.Model.load(file);
        const computed = model.certify({ neighbours, weld });
        const loaded = sscc.Certificates.load(await read(`${name}.certificates`));
        for (const [what, found, wanted] of [
            ["model", model.toBytes(), file],
            ["certificates", computed.toBytes(), loaded.toBytes()],
            ["answers", answers(sscc, model, computed, motion), await read(`${name}.answers`)],
        ]) {
            const at = difference(found, wanted);
            if (at) differences.push(`${name}: ${what}: ${at}`);
        }
        if (batchDiffers(sscc, model, computed, motion)) differences.push(`${name}: batch`);
        for (const object of [model, computed, loaded]) object.free();
    }
    return { models: models.length, differences };
}
