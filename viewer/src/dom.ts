/** DOM elements in one expression, numbers as text, and downloads. */
type Child = Node | string | null | false;
type Attributes = Record<string, string | number | boolean | null | ((event: never) => void)>;

function fill(element: Element, attributes: Attributes, children: Child[]): void {
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === false) continue;
        if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
        else element.setAttribute(name, value === true ? "" : String(value));
    }
    for (const child of children) if (child !== null && child !== false) element.append(child);
}

export function h<K extends keyof HTMLElementTagNameMap>(
    tag: K,
    attributes: Attributes = {},
    ...children: Child[]
): HTMLElementTagNameMap[K] {
    const element = document.createElement(tag);
    fill(element, attributes, children);
    return element;
}

export function svg<K extends keyof SVGElementTagNameMap>(
    tag: K,
    attributes: Attributes = {},
    ...children: Child[]
): SVGElementTagNameMap[K] {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    fill(element, attributes, children);
    return element;
}

/** A number with `n` significant digits, or with all digits of its integer part if these are more; infinite for null. */
export function digits(value: number | null | undefined, n = 4): string {
    if (value === null || value === undefined) return "infinite";
    if (!Number.isFinite(value)) return String(value);
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size >= 1e6 || size < 1e-4) return value.toExponential(n - 1).replace("e+", "e");
    if (size >= 10 ** n) return Math.round(value).toLocaleString("en");
    return value.toPrecision(n);
}

export function count(value: number, one: string, many = `${one}s`): string {
    return `${value.toLocaleString("en")} ${value === 1 ? one : many}`;
}

/** A duration (microseconds) in a suitable unit. */
export function duration(microseconds: number): string {
    if (microseconds < 1) return `${Math.round(microseconds * 1000)} ns`;
    if (microseconds < 1000) return `${digits(microseconds, 3)} µs`;
    if (microseconds < 1e6) return `${digits(microseconds / 1000, 3)} ms`;
    return `${digits(microseconds / 1e6, 3)} s`;
}

/** Closes and removes a dialog. A dialog that is only closed keeps the focus until the next frame. */
export function dismiss(dialog: HTMLDialogElement): void {
    dialog.close();
    dialog.remove();
}

export function save(name: string, data: Blob): void {
    const link = h("a", { href: URL.createObjectURL(data), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
