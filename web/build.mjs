// Builds web/dist: the page's bundle (three.js apart, loaded when a shape is first shown), the worker, styles, files.
// Names carry a hash of their content, so a browser may keep them for ever; index.html alone has a fixed name.
import { build } from "esbuild";
import { cp, mkdir, readFile, rename, rm, writeFile } from "node:fs/promises";
import { brotliCompressSync, gzipSync } from "node:zlib";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const fresh = path.join(here, "dist.new");
const common = { bundle: true, minify: true, sourcemap: false, legalComments: "none", metafile: true, target: ["es2022"] };

await rm(fresh, { recursive: true, force: true });
await mkdir(path.join(fresh, "assets"), { recursive: true });
const outdir = path.join(fresh, "assets");

// The worker first: the page is told its name.
const worker = await build({
  ...common, entryPoints: [path.join(here, "src/worker/worker.js")], outdir, format: "iife", entryNames: "worker-[hash]",
});
const page = await build({
  ...common,
  entryPoints: [path.join(here, "src/main.js"), path.join(here, "styles/page.css")],
  outdir, format: "esm", splitting: true, entryNames: "[name]-[hash]", chunkNames: "[name]-[hash]",
  define: { WORKER_FILE: JSON.stringify(nameOf(worker, "worker/worker.js")) },
});

/** File name in assets/ that was built from the entry point ending in `entry`. */
function nameOf(result, entry) {
  for (const [file, info] of Object.entries(result.metafile.outputs)) {
    if (info.entryPoint?.endsWith(entry)) return path.basename(file);
  }
  throw new Error(`esbuild made nothing of ${entry}`);
}

const script = nameOf(page, "src/main.js");
const style = nameOf(page, "styles/page.css");
const html = (await readFile(path.join(here, "index.html"), "utf8"))
  .replace("src/main.js", `assets/${script}`)
  .replace("styles/page.css", `assets/${style}`);
await writeFile(path.join(fresh, "index.html"), html);
await cp(path.join(here, "static"), fresh, { recursive: true });

await rm(path.join(here, "dist"), { recursive: true, force: true });
await rename(fresh, path.join(here, "dist"));

// What a first visit loads; the bar is 300 KB compressed for everything together.
const files = [...Object.keys(worker.metafile.outputs), ...Object.keys(page.metafile.outputs)].map((file) => path.basename(file));
let total = 0;
for (const name of files) {
  const bytes = await readFile(path.join(here, "dist/assets", name));
  const gzip = gzipSync(bytes, { level: 9 }).length;
  total += gzip;
  console.log(`  ${name.padEnd(28)} ${kilo(bytes.length)} KB, gzip ${kilo(gzip)} KB, br ${kilo(brotliCompressSync(bytes).length)} KB`);
}
console.log(`  all of it gzip ${kilo(total)} KB`);
function kilo(bytes) { return (bytes / 1024).toFixed(0).padStart(4); }
