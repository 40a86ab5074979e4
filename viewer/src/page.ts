/** Creates all parts of the page and connects them. */
import type { App } from "./app";
import { attempt } from "./app";
import { CertificatesPanel } from "./certificates-panel";
import { Checker } from "./checker";
import { CollisionsPanel } from "./collisions-panel";
import { ContactsPanel } from "./contacts-panel";
import { h } from "./dom";
import { exportGlb, exportPng } from "./export";
import { Frames } from "./frames";
import { Gauge } from "./gauge";
import { help } from "./help";
import { keyboard } from "./keyboard";
import type { Layout, Tab } from "./layout";
import { loadQ } from "./load-q";
import { isMesh } from "./mesh";
import { ModesPanel } from "./modes-panel";
import { Motion } from "./motion";
import { Player } from "./player";
import { PlotsPanel } from "./plots-panel";
import { Pose } from "./pose";
import { Shape } from "./shape";
import type { Source } from "./source";
import { Stage } from "./stage";
import { Theme } from "./theme";

function openStage(layout: Layout, frames: Frames): Stage | null {
    try {
        return new Stage(layout.canvas, frames);
    } catch {
        layout.noPicture();
        return null;
    }
}

export async function page(source: Source, layout: Layout): Promise<void> {
    const { scene } = source;
    let drawn = (): void => undefined;
    const frames = new Frames(() => drawn());
    let recolour = (): void => undefined;
    const theme = new Theme(() => recolour());
    if (scene.models.length === 0) {
        const plots = new PlotsPanel({ scene } as App);
        layout.withoutShape();
        layout.setTabs([{ name: "Plots", content: plots.element }, ...summary(source)]);
        return;
    }
    const arriving = Shape.load(source, scene.models[0]);
    // Opens the stage while the arrays load.
    const stage = openStage(layout, frames);
    const shape = await arriving;
    const pose = new Pose(Float64Array.from(shape.model.default_q));
    const checker = source.checks ? new Checker(source) : null;
    const motion = new Motion(frames, pose, checker);
    const shared: App = {
        source,
        scene,
        frames,
        shape,
        pose,
        motion,
        checker,
        stage,
        body: null,
        chosen: null,
        recorded: null,
        refreshMarks: () => marks(shared),
        takeOver: () => {
            motion.stop();
            player.timeline?.pause();
        },
        playRows: (rows) => player.playRows(rows),
        say: (message, wrong) => layout.say(message, wrong),
    };
    const player = new Player(shared, layout);
    const gauge = new Gauge(shared);
    recolour = () => stage?.recolour();
    drawn = () => {
        gauge.update();
        stage?.draw();
    };
    pose.onChange(() => {
        layout.settle();
        if (checker && checker.lastSerial < pose.serial) void checker.check(pose.q, pose.serial);
        player.explore();
        shared.body?.setQ(0, pose.q);
        marks(shared);
        frames.invalidate();
    });
    checker?.onAnswer(() => {
        if (checker.error) shared.say(checker.error, true);
        marks(shared);
        frames.invalidate();
    });

    // A mesh of a recording has no modes and no certificates.
    const modes = isMesh(shape.model) ? null : new ModesPanel(shared);
    const certificates = isMesh(shape.model) ? null : new CertificatesPanel(shared);
    const collisions = checker ? new CollisionsPanel(shared) : null;
    const contacts = scene.playback?.contacts ? new ContactsPanel(player) : null;
    const plots = new PlotsPanel(shared);
    player.onFrame((time) => plots.setTime(time));
    const tabs: Tab[] = [
        ...(modes ? [{ name: "Modes", content: modes.element }] : []),
        ...(collisions ? [{ name: "Collisions", content: collisions.element }] : []),
        ...(contacts ? [{ name: "Collisions", content: contacts.element }] : []),
        ...(certificates ? [{ name: "Certificates", content: certificates.element }] : []),
        { name: "Plots", content: plots.element },
        ...summary(source),
    ];
    layout.below.append(gauge.element);
    layout.setTabs(tabs);

    const actions = {
        png: () => void attempt(shared, () => exportPng(shared)),
        glb: () => void attempt(shared, () => exportGlb(shared, player.shown)),
        theme: () => theme.toggle(),
    };
    layout.button("PNG", "save a picture of the view (P)", actions.png);
    layout.button("GLB", "save the motion as GLB (G)", actions.glb);
    layout.button("◐", "light or dark (T)", actions.theme);
    const pairs = collisions ?? contacts;
    const has = { modes: modes !== null, server: source.live && modes !== null, pairs: pairs !== null };
    const keys = (): void => help(has);
    layout.button("?", "help (?)", keys);
    keyboard({
        " ": () => (player.timeline ? player.timeline.toggle() : modes?.vibrate(modes.focused() ?? 0)),
        ",": () => player.step(-1),
        ".": () => player.step(1),
        n: () => pairs?.next(1),
        N: () => pairs?.next(-1),
        f: () => stage?.flyHome(),
        h: () => stage?.toggleCut(),
        u: () => player.turnUp(),
        p: actions.png,
        g: actions.glb,
        t: actions.theme,
        "?": keys,
        ...(modes && {
            "[": () => modes.step(-1),
            "]": () => modes.step(1),
            "/": () => {
                layout.select("Modes");
                modes.find();
            },
            v: () => modes.vibrate(modes.focused() ?? 0),
            c: source.live ? () => modes.randomCollision() : undefined,
            x: () => modes.random(),
            r: () => modes.reset(),
            l: () => loadQ(shared),
        }),
        ...(source.live && certificates && { k: () => certificates.cycle(), b: () => certificates.toggleBoxes() }),
    });
    await player.begin();
    contacts?.changed();
    // For tests and debugging.
    Object.assign(globalThis, { sscc: shared, player });
}

/**
 * Marks the colliding triangles of the last answer; the gauge shows whether that answer is for the displayed q. Marks
 * nothing if the root's certificate holds.
 */
function marks(app: App): void {
    const { body, checker, chosen } = app;
    if (!body || !checker) return;
    const answer = app.shape.isRootCertified(app.pose.q) ? null : checker.answer;
    body.setMarks(0, answer?.triangles ?? answer?.pairs.flat() ?? [], chosen ?? []);
}

function summary(source: Source): Tab[] {
    const { scene } = source;
    const rows = scene.summary.map(([label, value]) =>
        h("tr", {}, h("th", { scope: "row" }, label), h("td", {}, value)),
    );
    const checks = source.checks ? " It checks each shape itself, by the core of sscc within it." : "";
    const text = source.live
        ? "This page exchanges data only with the program on this machine."
        : `This report is one file. It loads no other file and uses no network.${checks}`;
    return [
        {
            name: "About",
            content: h(
                "div",
                { class: "about" },
                h("table", { class: "facts" }, ...rows),
                h("p", { class: "hint" }, `${text} sscc ${scene.version}.`),
            ),
        },
    ];
}
