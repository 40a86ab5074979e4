// The package. A q in a Float64Array is written directly to the memory of the module, and answers without pairs share one array. The
// module's own methods allocate memory for each q and an array for each answer, which takes longer than the query. They do all other
// work, including errors.
import { Batch, Impacts, Query, initSync } from "./sscc.js";

export * from "./sscc.js";
export { default } from "./sscc.js";

/** The memory of the module as numbers; both arrays are empty before the first answer, and after that memory has grown. */
let doubles = new Float64Array(0);
let integers = new Uint32Array(0);

function renew() {
    const { memory } = initSync();
    doubles = new Float64Array(memory.buffer);
    integers = new Uint32Array(memory.buffer);
}

/** The limit for all pairs: in the module it is the largest number. */
const ALL = -1;

/** Properties of a query: the index in `doubles` at which the module reads q, and the length of q. A freed query has no length. */
const AT = Symbol("at");
const LENGTH = Symbol("length");

const { discrete, isColliding, count, free } = Query.prototype;

/** Returns the number of pairs at q, at most `limit`; -1 if only the method of the module can answer. */
function find(query, q, limit) {
    // Other arrays may have values that are not numbers.
    if (!(q instanceof Float64Array)) return -1;
    if (q.length !== query[LENGTH]) {
        const address = query.addressOfQ(q.length);
        if (address === 0) return -1;
        query[AT] = address / 8;
        query[LENGTH] = q.length;
    }
    if (doubles.length === 0) renew();
    doubles.set(q, query[AT]);
    return query.find(limit);
}

/** The array of all answers without pairs, and an empty view of its buffer. The view throws after the buffer was transferred, which is the fastest test. */
let none = new Uint32Array(0);
let view = new DataView(none.buffer);

function noPairs() {
    try {
        view.byteLength;
    } catch {
        none = new Uint32Array(0);
        view = new DataView(none.buffer);
    }
    return none;
}

Query.prototype.discrete = function (q) {
    const found = find(this, q, ALL);
    if (found < 0) return discrete.call(this, q);
    if (found === 0) return noPairs();
    const at = this.addressOfPairs() / 4;
    if (integers.length === 0) renew();
    return integers.slice(at, at + 2 * found);
};

Query.prototype.isColliding = function (q) {
    const found = find(this, q, 1);
    return found < 0 ? isColliding.call(this, q) : found > 0;
};

Query.prototype.count = function (q) {
    const found = find(this, q, ALL);
    return found < 0 ? count.call(this, q) : found;
};

Query.prototype.free = function () {
    this[LENGTH] = undefined;
    free.call(this);
};
if (Symbol.dispose) Query.prototype[Symbol.dispose] = Query.prototype.free;

// Arrays of an answer are copied at the first access. From then on the answer itself has them.
for (const [type, names] of [
    [Batch, ["pairs", "offsets"]],
    [Impacts, ["pairs", "times"]],
]) {
    for (const name of names) {
        const { get } = Object.getOwnPropertyDescriptor(type.prototype, name);
        const copyOnce = function () {
            const value = get.call(this);
            Object.defineProperty(this, name, { value });
            return value;
        };
        Object.defineProperty(type.prototype, name, { get: copyOnce, configurable: true });
    }
}
