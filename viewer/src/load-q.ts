/** Input of q: pasted numbers, or a text or .npy file. Several rows are a trajectory. */
import { type App, attempt } from "./app";
import { count, dismiss, h } from "./dom";
import { readNpy } from "./npy";

/**
 * Reads rows of numbers, separated by commas, blanks, semicolons, parentheses or brackets. Each line is a row, except empty lines
 * and those that begin with #.
 */
export function parseRows(text: string, rank: number): number[][] {
    const lines = text
        .split(/\r\n|\n|\r/)
        .map((line, i) => ({ number: i + 1, words: line.replace(/[[\]();,]/g, " ").trim() }))
        .filter(({ words }) => words !== "" && !words.startsWith("#"));
    const rows = lines.map(({ number, words }) =>
        words.split(/\s+/).map((word) => {
            const value = Number(word);
            if (!Number.isFinite(value)) throw new Error(`line ${number}: '${word.slice(0, 20)}' is not a number`);
            return value;
        }),
    );
    // One number in each line, or one row broken into lines, is one q.
    if (rows.length > 1 && rows.some((row) => row.length !== rank) && rows.flat().length === rank)
        return [rows.flat()];
    return checkRows(rows, rank);
}

export function checkRows(rows: number[][], rank: number): number[][] {
    if (rows.length === 0) throw new Error(`there are no numbers: enter ${count(rank, "number")}`);
    const bad = rows.findIndex((row) => row.length !== rank);
    if (bad >= 0)
        throw new Error(
            `row ${bad} (counted from 0) has ${count(rows[bad].length, "number")}, the model has ${count(rank, "mode")}`,
        );
    if (rows.some((row) => row.some((v) => !Number.isFinite(v)))) throw new Error("every number must be finite");
    return rows;
}

export async function rowsOfFile(file: File, rank: number): Promise<number[][]> {
    if (file.size > 256 * 1024 * 1024) throw new Error(`${file.name} is larger than 256 MiB`);
    if (file.name.endsWith(".npy")) return checkRows(readNpy(await file.arrayBuffer(), rank), rank);
    return parseRows(await file.text(), rank);
}

/** Shows one q, or plays several as a trajectory. */
export function showRows(app: App, rows: number[][]): void {
    app.takeOver();
    if (rows.length === 1) {
        app.pose.show(rows[0]);
        return;
    }
    app.playRows(rows);
}

export function loadQ(app: App): void {
    const { rank } = app.shape.model;
    const text = h("textarea", {
        rows: 6,
        "aria-label": "numbers",
        placeholder: `${count(rank, "number")}; one row for each q`,
    });
    text.value = [...app.pose.q].join(" ");
    const wrong = h("p", { class: "wrong", role: "alert" });
    const load = async (rows: Promise<number[][]>): Promise<void> => {
        try {
            showRows(app, await rows);
            dismiss(dialog);
        } catch (error) {
            wrong.textContent = (error as Error).message;
        }
    };
    const file = h("input", {
        type: "file",
        accept: ".npy,.txt,.csv",
        "aria-label": "file",
        onchange: () => file.files?.[0] && void load(rowsOfFile(file.files[0], rank)),
    });
    const dialog = h(
        "dialog",
        { class: "dialog", "aria-label": "load q" },
        h("h2", {}, "Load q"),
        h(
            "p",
            {},
            `Numbers separated by blanks or commas, ${rank} to a row; or a text or .npy file. ` +
                "Several rows are played as a motion.",
        ),
        text,
        file,
        wrong,
        h(
            "div",
            { class: "actions" },
            h(
                "button",
                {
                    type: "button",
                    class: "primary",
                    onclick: () => void load(Promise.resolve().then(() => parseRows(text.value, rank))),
                },
                "Show",
            ),
            h(
                "button",
                {
                    type: "button",
                    onclick: () => void attempt(app, () => navigator.clipboard.writeText([...app.pose.q].join(","))),
                },
                "Copy the displayed q",
            ),
            h("button", { type: "button", onclick: () => dismiss(dialog) }, "Close"),
        ),
    );
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
    text.select();
}
