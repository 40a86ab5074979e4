import { defineConfig, type Plugin } from "vite";

/** Puts the script and the style into the page, so that it is one file. */
function oneFile(): Plugin {
    return {
        name: "one-file",
        enforce: "post",
        generateBundle(_options, bundle) {
            const page = bundle["index.html"];
            if (page?.type !== "asset") throw new Error("the build has no index.html");
            let html = String(page.source);
            for (const [name, part] of Object.entries(bundle)) {
                if (name === "index.html") continue;
                const text = part.type === "chunk" ? part.code : String(part.source);
                const tag =
                    part.type === "chunk"
                        ? `<script type="module">${text.trim().replaceAll("</script", "<\\/script")}</script>`
                        : `<style>${text.trim()}</style>`;
                const link = new RegExp(`[ \\t]*<(script|link)[^>]*"[^"]*${name}"[^>]*>(</script>)?\\n?`);
                if (!link.test(html)) throw new Error(`index.html does not name ${name}`);
                // The script goes to the end of the body, after the elements that it uses.
                html = html.replace(link, "");
                const end = part.type === "chunk" ? "</body>" : "</head>";
                html = html.replace(end, () => `${tag}\n${end}`);
                delete bundle[name];
            }
            page.source = html;
        },
    };
}

export default defineConfig({
    base: "./",
    plugins: [oneFile()],
    build: {
        target: "es2022",
        outDir: "dist",
        emptyOutDir: true,
        modulePreload: false,
        assetsInlineLimit: 100_000_000,
        cssCodeSplit: false,
        reportCompressedSize: false,
        chunkSizeWarningLimit: 2000,
    },
});
