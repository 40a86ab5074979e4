/** Keyboard shortcuts outside of text fields; help.ts describes them. */
export function keyboard(actions: Record<string, (() => void) | undefined>): void {
    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        if (document.querySelector("dialog[open]")) return;
        const target = event.target as HTMLElement;
        const typing = target.matches("textarea, select, input:not([type=range]):not([type=checkbox])");
        const pressing = event.key === " " && target.matches("button, input, select, summary");
        if (typing || (pressing && !target.matches("input[type=range]"))) return;
        const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
        const action = actions[event.shiftKey && key === "n" ? "N" : key];
        if (!action) return;
        event.preventDefault();
        action();
    });
}
