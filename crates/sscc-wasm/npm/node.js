// The package in Node: the module is ready after the import.
import { readFileSync } from "node:fs";
import { initSync } from "./sscc.js";

initSync({ module: readFileSync(new URL("./sscc_bg.wasm", import.meta.url)) });

export * from "./queries.js";

/** Does nothing, so that programs for browsers, which must wait for the module, also run in Node. */
export default async function init() {}
