/** The colliding pairs of the displayed frame of a recording. */
import type { Contact } from "./contacts";
import { count, h } from "./dom";
import type { Player } from "./player";

const FIRST_ROWS = 100;

export class ContactsPanel {
    private readonly heading = h("h2", {}, "Pairs");
    private readonly hint = h("p", { class: "hint" });
    private readonly list = h("ol", { class: "pairs" });
    readonly element = h("div", { class: "collisions" }, this.heading, this.hint, this.list);
    private contacts: Contact[] = [];
    private frame = 0;
    private rows = FIRST_ROWS;
    private at = -1;

    constructor(private readonly player: Player) {
        player.onFrame(() => this.changed());
    }

    /** Flies to the pair `step` rows further in the list. */
    next(step: number): void {
        if (this.contacts.length > 0) this.go((this.at + step + this.contacts.length) % this.contacts.length);
    }

    /** Shows the pairs of the displayed frame. */
    changed(): void {
        const { meshes, timeline } = this.player;
        if (!meshes?.contacts || !timeline) return;
        this.frame = timeline.frame;
        this.contacts = meshes.contacts.of(this.frame);
        this.rows = FIRST_ROWS;
        this.at = -1;
        const { isContinuous, isBetween } = meshes.contacts;
        const place = isContinuous ? "from this frame to the next" : "in this frame";
        const { length } = this.contacts;
        const any = length > 0 ? `${count(length, "colliding pair")} ${place}` : `No pair collides ${place}`;
        this.heading.textContent = meshes.isEnd(this.frame) ? "The last frame: no step follows" : any;
        const names = meshes.data.bodies.map((body) => body.name);
        const of = isBetween ? `Triangles of ${names[0]} – triangles of ${names[1]}. ` : "";
        const times = isContinuous ? "With the time of impact in the step, from 0 to 1. " : "";
        this.hint.textContent = `${of}${times}N flies to the next pair, H shows what is cut away in front of it.`;
        this.show();
    }

    private go(at: number): void {
        this.at = at;
        this.player.timeline?.pause();
        this.player.meshes?.choose(this.contacts[at], this.frame);
        this.show();
    }

    private show(): void {
        const bodies = this.player.meshes?.data.bodies ?? [];
        const several = bodies.length > 1 && !this.player.meshes?.contacts?.isBetween;
        const text = ({ bodies: [body, second], pair, time }: Contact): string => {
            const other = body === second ? "" : ` – ${bodies[second].name}`;
            const name = several ? `${bodies[body].name}${other}: ` : "";
            return `${name}${pair[0]} – ${pair[1]}${time === null ? "" : ` at ${time.toFixed(4)}`}`;
        };
        const rows = this.contacts.slice(0, this.rows).map((contact, i) => {
            const attributes = { type: "button", class: "pair", "aria-pressed": String(i === this.at) };
            return h("li", {}, h("button", { ...attributes, onclick: () => this.go(i) }, text(contact)));
        });
        const hidden = this.contacts.length - rows.length;
        if (hidden > 0) {
            const more = (): void => {
                this.rows += 1000;
                this.show();
            };
            rows.push(
                h("li", {}, h("button", { type: "button", onclick: more }, `${hidden.toLocaleString("en")} more`)),
            );
        }
        this.list.replaceChildren(...rows);
    }
}
