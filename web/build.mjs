// Builds web/dist: the page's bundle (three.js apart, loaded when a shape is first shown), the worker, styles, files.
// Names carry a hash of their content, so a browser may keep them for ever; index.html alone has a fixed name.
import { build } from "esbuild";
import { cp, mkdir, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { gzipSync } from "node:zlib";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const fresh = path.join(here, "dist.new");
const common = {
  bundle: true,
  minify: true,
  sourcemap: false,
  legalComments: "none",
  metafile: true,
  target: ["es2022"],
};

await rm(fresh, { recursive: true, force: true });
await mkdir(path.join(fresh, "assets"), { recursive: true });
const outdir = path.join(fresh, "assets");

// The worker first: the page is told its name.
const worker = await build({
  ...common,
  entryPoints: [path.join(here, "src/worker/worker.js")],
  outdir,
  format: "iife",
  entryNames: "worker-[hash]",
});
const page = await build({
  ...common,
  entryPoints: [path.join(here, "src/main.js"), path.join(here, "styles/page.css")],
  outdir,
  format: "esm",
  splitting: true,
  entryNames: "[name]-[hash]",
  chunkNames: "[name]-[hash]",
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

// What a first visit loads, compressed; the bar is 300 KB for everything together. The server sends the .gz as it is.
let total = 0;
for (const name of await filesIn(fresh)) {
  const bytes = await readFile(path.join(fresh, name));
  const packed = gzipSync(bytes, { level: 9 });
  if (/\.(js|css|html|svg)$/.test(name)) await writeFile(path.join(fresh, `${name}.gz`), packed);
  total += packed.length;
  console.log(`  ${name.padEnd(30)} ${kilo(bytes.length)} KB, gzip ${kilo(packed.length)} KB`);
}
console.log(`  all of it, gzip ${kilo(total)} KB`);

// Files that did not change keep their time, so that nothing is linked again for nothing.
const dist = path.join(here, "dist");
const wanted = new Set(await filesIn(fresh));
for (const name of await filesIn(dist)) if (!wanted.has(name)) await rm(path.join(dist, name));
for (const name of wanted) {
  const [next, old] = [await readFile(path.join(fresh, name)), await readFile(path.join(dist, name)).catch(() => null)];
  if (old && next.equals(old)) continue;
  await mkdir(path.dirname(path.join(dist, name)), { recursive: true });
  await writeFile(path.join(dist, name), next);
}
await rm(fresh, { recursive: true });

/** Paths of all files below a folder, sorted; none when it is not there. */
async function filesIn(folder, prefix = "") {
  const entries = await readdir(path.join(folder, prefix), { withFileTypes: true }).catch(() => []);
  const found = await Promise.all(
    entries.map((entry) => {
      const name = path.posix.join(prefix, entry.name);
      return entry.isDirectory() ? filesIn(folder, name) : [name];
    }),
  );
  return found.flat().sort();
}

function kilo(bytes) {
  return (bytes / 1024).toFixed(0).padStart(4);
}
