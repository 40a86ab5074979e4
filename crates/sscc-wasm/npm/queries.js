// The package. Queries take a Float64Array and answer without pairs by a way of their own, since the module's own methods allocate memory for each q, pack
// results into arrays and make a new array for no pairs, all of which takes longer than the query. These methods do all else, errors too.
import { Query, initSync } from "./sscc.js";

export * from "./sscc.js";
export { default } from "./sscc.js";

/** The memory of the module as numbers; without any before the first answer, and again where that memory has grown. */
let doubles = new Float64Array(0);
let integers = new Uint32Array(0);

function view() {
    const { memory } = initSync();
    doubles = new Float64Array(memory.buffer);
    integers = new Uint32Array(memory.buffer);
}

/** All pairs: in the module this is the largest number. */
const ALL = -1;

/** Properties of a query: where in `doubles` the module reads q, and how many numbers that are. A freed one has no length. */
const AT = Symbol("at");
const LENGTH = Symbol("length");

const { discrete, isColliding, count, free } = Query.prototype;

/** The number of pairs at q, at most `limit`; -1 where only the method of the module may answer. */
function find(query, q, limit) {
    // Other arrays may have values that are no numbers.
    if (!(q instanceof Float64Array)) return -1;
    if (q.length !== query[LENGTH]) {
        const address = query.addressOfQ(q.length);
        if (address === 0) return -1;
        query[AT] = address / 8;
        query[LENGTH] = q.length;
    }
    if (doubles.length === 0) view();
    doubles.set(q, query[AT]);
    return query.find(limit);
}

/** The array of all answers without pairs, and a number in its buffer, which is gone once the buffer was transferred. */
let guard = new Uint32Array(1);
let none = new Uint32Array(guard.buffer, 4, 0);

function noPairs() {
    if (guard.length === 0) {
        guard = new Uint32Array(1);
        none = new Uint32Array(guard.buffer, 4, 0);
    }
    return none;
}

Query.prototype.discrete = function (q) {
    const found = find(this, q, ALL);
    if (found < 0) return discrete.call(this, q);
    if (found === 0) return noPairs();
    const at = this.addressOfPairs() / 4;
    if (integers.length === 0) view();
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
