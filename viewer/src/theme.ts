/** Light and dark theme: the system's choice, unless a person switches it. Colours are in style.css. */
export interface Colours {
    ground: [number, number, number];
    background: [number, number, number];
    base: [number, number, number];
    hit: [number, number, number];
    hitDark: [number, number, number];
    chosen: [number, number, number];
    line: [number, number, number];
    curve: [number, number, number];
    curveEdge: [number, number, number];
}

function parse(text: string): [number, number, number] {
    const typed = text.trim().replace("#", "");
    // The build shortens #ffffff to #fff.
    const hex = typed.length === 3 ? typed.replace(/./g, "$&$&") : typed;
    return [0, 2, 4].map((i) => Number.parseInt(hex.slice(i, i + 2), 16) / 255) as [number, number, number];
}

export function colours(): Colours {
    const style = getComputedStyle(document.documentElement);
    const get = (name: string): [number, number, number] => parse(style.getPropertyValue(`--${name}`));
    return {
        ground: get("ground"),
        background: get("stage"),
        base: get("shape"),
        hit: get("hit"),
        hitDark: get("hit-dark"),
        chosen: get("chosen"),
        line: get("box-line"),
        curve: get("curve"),
        curveEdge: get("curve-edge"),
    };
}

export class Theme {
    private readonly system = matchMedia("(prefers-color-scheme: dark)");
    private choice: "light" | "dark" | null = null;

    constructor(private readonly changed: () => void) {
        this.system.addEventListener("change", () => this.apply());
        this.apply();
    }

    get dark(): boolean {
        return this.choice ? this.choice === "dark" : this.system.matches;
    }

    toggle(): void {
        this.choice = this.dark ? "light" : "dark";
        this.apply();
    }

    private apply(): void {
        document.documentElement.dataset.theme = this.dark ? "dark" : "light";
        this.changed();
    }
}
