/** The layout of the page: header, picture, panels and messages. */
import { h } from "./dom";

export interface Tab {
    name: string;
    content: HTMLElement;
}

export class Layout {
    readonly canvas = h("canvas", {
        tabindex: 0,
        role: "img",
        "aria-label": "the shape; drag or use the arrows to rotate it, plus and minus to zoom",
    });
    readonly stage = h("div", { class: "stage" }, this.canvas);
    readonly below = h("div", { class: "below" });
    private readonly buttons = h("div", { class: "buttons" });
    private readonly heading = h("h1", {}, "sscc");
    private readonly subtitle = h("p", { class: "subtitle" });
    private readonly text = h("span", {});
    private readonly dismiss = h(
        "button",
        { type: "button", class: "small", "aria-label": "dismiss the message", onclick: () => this.say("") },
        "×",
    );
    /** In place of the subtitle, where it covers nothing. */
    private readonly message = h("p", { class: "message", role: "status", hidden: true }, this.text, this.dismiss);
    private isWrong = false;
    private readonly tabs = h("div", { class: "tabs", role: "tablist", "aria-label": "panels" });
    private readonly panel = h("aside", { class: "panel" }, this.tabs);
    private timer = 0;

    constructor(root: HTMLElement) {
        root.append(
            h("header", {}, h("div", { class: "titles" }, this.heading, this.subtitle, this.message), this.buttons),
            h("main", {}, h("div", { class: "left" }, this.stage, this.below), this.panel),
        );
    }

    title(title: string, subtitle: string): void {
        document.title = `${title} · sscc`;
        this.heading.textContent = title;
        this.subtitle.textContent = subtitle;
    }

    button(text: string, title: string, action: () => void): HTMLButtonElement {
        const button = h("button", { type: "button", title, "aria-label": title, onclick: action }, text);
        this.buttons.append(button);
        return button;
    }

    /** Shows a message. A result stays for some seconds, an error until its cause is gone: see `settle`. */
    say(message: string, wrong = false): void {
        clearTimeout(this.timer);
        this.isWrong = wrong;
        this.text.textContent = message;
        this.message.hidden = message === "";
        this.subtitle.hidden = message !== "";
        this.dismiss.hidden = !wrong;
        this.message.classList.toggle("wrong", wrong);
        this.message.setAttribute("role", wrong ? "alert" : "status");
        if (!wrong) this.timer = window.setTimeout(() => this.say(""), 7000);
    }

    /** Removes an error, because another shape is displayed or the server answers again. */
    settle(): void {
        if (this.isWrong) this.say("");
    }

    /** Shows the tab of this name. */
    select(name: string): void {
        for (const tab of this.tabs.children) if (tab.textContent === name) (tab as HTMLElement).click();
    }

    setTabs(tabs: Tab[]): void {
        const buttons: HTMLButtonElement[] = [];
        const select = (at: number): void => {
            tabs.forEach((tab, i) => {
                tab.content.hidden = i !== at;
                buttons[i].setAttribute("aria-selected", String(i === at));
                buttons[i].tabIndex = i === at ? 0 : -1;
            });
        };
        tabs.forEach((tab, i) => {
            const id = `tab-${tab.name.toLowerCase().replace(/\W+/g, "-")}`;
            tab.content.setAttribute("role", "tabpanel");
            tab.content.setAttribute("aria-labelledby", id);
            tab.content.classList.add("tab-content");
            const key = (event: KeyboardEvent): void => {
                const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
                if (step === 0) return;
                const to = (i + step + tabs.length) % tabs.length;
                select(to);
                buttons[to].focus();
            };
            buttons.push(
                h("button", { type: "button", role: "tab", id, onclick: () => select(i), onkeydown: key }, tab.name),
            );
            this.panel.append(tab.content);
        });
        this.tabs.append(...buttons);
        select(0);
    }

    /** Removes the picture, so that plots and tables have the whole width. */
    withoutShape(): void {
        this.stage.parentElement?.remove();
        this.panel.classList.add("alone");
    }

    /** Shows a message in place of the picture. */
    noPicture(): void {
        this.stage.replaceChildren(
            h(
                "div",
                { class: "no-picture", role: "alert" },
                h("h2", {}, "No picture: WebGL 2 is missing"),
                h(
                    "p",
                    {},
                    "This browser has no WebGL 2, or it is switched off, so the page cannot draw shapes. " +
                        "Sliders, answers, pairs and plots work without it.",
                ),
            ),
        );
    }
}
