/** The two sources of the page's data: the local server, or the report within the page. */
import { LocalChecks } from "./local-checks";
import { completeScene } from "./mesh";
import type { Report, Scene } from "./protocol";

/** The source has no such data, or the server refuses a request. */
export class RequestError extends Error {}

/** The server does not answer. */
export class ConnectionError extends Error {}

export interface Source {
    /** Whether there is a server. */
    readonly live: boolean;
    /** Whether `/api/check` is answered: by the server, or within the report. */
    readonly checks: boolean;
    readonly scene: Scene;
    array(name: string): Promise<ArrayBuffer>;
    /** Sends a request to the server. A report answers `/api/check` itself if it has checks, and throws for other requests. */
    ask<T>(path: string, body?: unknown, signal?: AbortSignal): Promise<T>;
    bytes(path: string, body?: unknown): Promise<ArrayBuffer>;
}

export async function openSource(): Promise<Source> {
    const text = document.getElementById("sscc-report")?.textContent ?? "null";
    const report = JSON.parse(text) as Report | null;
    return report ? new ReportSource(report) : LiveSource.open();
}

class ReportSource implements Source {
    readonly live = false;
    readonly checks: boolean;
    readonly scene: Scene;
    private local: Promise<LocalChecks> | null = null;
    constructor(private readonly report: Report) {
        this.scene = completeScene(report.scene);
        this.checks = Boolean(report.checks);
    }
    async array(name: string): Promise<ArrayBuffer> {
        const text = this.report.arrays[name];
        if (text === undefined) throw new RequestError(`the report has no array '${name}'`);
        const letters = atob(text);
        const bytes = new Uint8Array(letters.length);
        for (let i = 0; i < letters.length; i++) bytes[i] = letters.charCodeAt(i);
        return bytes.buffer;
    }
    async ask<T>(path: string, body?: unknown): Promise<T> {
        const { checks } = this.report;
        if (path !== "/api/check" || !checks) throw new RequestError("a report has no server for this request");
        this.local ??= LocalChecks.open(checks, (name) => this.array(name)).catch((error) => {
            // The next check opens them again.
            this.local = null;
            throw error;
        });
        const { q, serial } = body as { q: number[]; serial: number };
        return (await this.local).check(q, serial) as T;
    }
    bytes(path: string): Promise<ArrayBuffer> {
        return this.ask(path);
    }
}

class LiveSource implements Source {
    readonly live = true;
    readonly checks = true;
    private constructor(
        private readonly token: string,
        public scene: Scene,
    ) {}

    static async open(): Promise<LiveSource> {
        const address = new URL(location.href);
        const token = address.searchParams.get("token") ?? "";
        // Removes the token from the visible address and from histories. A reload finds it in the state.
        address.searchParams.delete("token");
        const known = token || (history.state as { token?: string } | null)?.token || "";
        history.replaceState({ token: known }, "", address);
        const source = new LiveSource(known, null as unknown as Scene);
        source.scene = await source.ask<Scene>("/api/scene");
        return source;
    }

    async array(name: string): Promise<ArrayBuffer> {
        return this.bytes(`/api/array/${encodeURIComponent(name)}`);
    }

    async ask<T>(path: string, body?: unknown, signal?: AbortSignal): Promise<T> {
        const response = await this.fetch(path, body, signal);
        return (await response.json()) as T;
    }

    async bytes(path: string, body?: unknown): Promise<ArrayBuffer> {
        return (await this.fetch(path, body)).arrayBuffer();
    }

    private async fetch(path: string, body?: unknown, signal?: AbortSignal): Promise<Response> {
        const headers: Record<string, string> = { "X-Sscc-Token": this.token };
        const init: RequestInit = { headers, cache: "no-store", signal: signal ?? null };
        if (body !== undefined) {
            headers["Content-Type"] = "application/json";
            init.method = "POST";
            init.body = JSON.stringify(body);
        }
        let response: Response;
        try {
            response = await fetch(path, init);
        } catch (error) {
            if (signal?.aborted) throw error;
            throw new ConnectionError(
                "The server does not answer: is 'sscc view' still running? Start it again and open its new address.",
            );
        }
        if (!response.ok) throw new RequestError(await explain(response));
        return response;
    }
}

async function explain(response: Response): Promise<string> {
    try {
        const { error } = (await response.json()) as { error?: string };
        if (error) return error;
    } catch {
        // The body is not JSON: the message has the status.
    }
    return `the server answered with ${response.status} ${response.statusText}`.trim();
}
