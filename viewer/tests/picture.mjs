// Measures the displayed picture.

/** The displayed pixels of an element: `at(x, y)` returns [r, g, b]. */
export async function pixels(page, selector = ".stage canvas") {
    const png = await page.locator(selector).screenshot();
    const data = await page.evaluate(async (base64) => {
        const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
        const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
        const canvas = new OffscreenCanvas(image.width, image.height);
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const raw = context.getImageData(0, 0, image.width, image.height).data;
        let text = "";
        for (let i = 0; i < raw.length; i += 32768) text += String.fromCharCode(...raw.subarray(i, i + 32768));
        return { width: image.width, height: image.height, raw: btoa(text) };
    }, png.toString("base64"));
    const raw = Buffer.from(data.raw, "base64");
    const at = (x, y) => [...raw.subarray(4 * (y * data.width + x), 4 * (y * data.width + x) + 3)];
    return { width: data.width, height: data.height, at };
}

/** The bounding box of all pixels that differ from the background in the corner. */
export function drawnBox(picture) {
    const background = picture.at(picture.width - 3, 3);
    const box = { left: picture.width, right: -1, top: picture.height, bottom: -1, count: 0 };
    for (let y = 0; y < picture.height; y++) {
        for (let x = 0; x < picture.width; x++) {
            const colour = picture.at(x, y);
            if (colour.every((c, i) => Math.abs(c - background[i]) < 12)) continue;
            box.left = Math.min(box.left, x);
            box.right = Math.max(box.right, x);
            box.top = Math.min(box.top, y);
            box.bottom = Math.max(box.bottom, y);
            box.count++;
        }
    }
    return box;
}

/** The bounding box in the picture of the positions p + U q by the processor. */
export function expectedBox(page) {
    return page.evaluate(() => {
        const { stage, shape, pose } = globalThis.sscc;
        const x = shape.deformed(pose.q);
        const camera = stage.camera;
        camera.updateMatrixWorld();
        const point = camera.position.clone();
        const { clientWidth: width, clientHeight: height } = stage.canvas;
        const box = { left: width, right: 0, top: height, bottom: 0 };
        for (let v = 0; v < x.length; v += 3) {
            point.set(x[v], x[v + 1], x[v + 2]).project(camera);
            const [px, py] = [((point.x + 1) / 2) * width, ((1 - point.y) / 2) * height];
            box.left = Math.min(box.left, px);
            box.right = Math.max(box.right, px);
            box.top = Math.min(box.top, py);
            box.bottom = Math.max(box.bottom, py);
        }
        return box;
    });
}

function count(picture, wanted) {
    let n = 0;
    for (let y = 0; y < picture.height; y++) {
        for (let x = 0; x < picture.width; x++) if (wanted(...picture.at(x, y))) n++;
    }
    return n;
}

/** Number of pixels in the orange of colliding triangles, which nothing else has. */
export const orange = (picture) => count(picture, (r, g, b) => r > 150 && r > 1.6 * g && g > b);

/** Number of pixels in the white of curves. */
export const white = (picture) => count(picture, (r, g, b) => Math.min(r, g, b) > 248);

/** Number of pixels in the yellow of deep nodes. */
export const yellow = (picture) => count(picture, (r, g, b) => r > 1.3 * b && r < 1.5 * g);

/** Number of pixels in the yellow of the chosen pair, which nothing else has. */
export const yellowMarks = (picture) => count(picture, (r, g, b) => r > 120 && r < 1.5 * g && g > 2.5 * b);

/** Waits until the next frame is drawn. */
export function settled(page) {
    return page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}
