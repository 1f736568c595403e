// The same result again: a link to it, and the commands that make it on a terminal.
import { queryOf } from "../api.js";
import { announce, h } from "../dom.js";
import { percent } from "../format.js";
import { jobs } from "../jobs.js";
import { materialOf } from "../materials.js";
import { isSweep } from "../result/trade_off.js";

/** Parameters of a job that differ from the defaults of the schema, as [name, value] pairs. */
export function askedFor(job, process) {
  return Object.entries(job.parameters ?? {}).filter(([name, value]) => {
    const fallback = process.inputs[name]?.schema?.default;
    return value !== null && (name === "e_max" || JSON.stringify(value) !== JSON.stringify(fallback));
  });
}

const word = (value) => (value === true ? "on" : value === false ? "off" : [value].flat().join(","));
const quoted = (text) => (/^[\w./,:=@+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
/** A file as a field of curl's form, where commas, semicolons and quotes mean something. */
const inForm = (file) => (/[,;"\\]/.test(file) ? `"${file.replaceAll(/["\\]/g, "\\$&")}"` : file);
const GUIDES = "guides.json";

/** Address of what was drawn on the job's mesh; null when nothing was. */
const guidesOf = (job) => job.links?.find(({ rel }) => rel === "guides")?.href ?? null;

/**
 * The commands that make a result again: on a terminal, and over HTTP. What was drawn on the shape goes with them as a
 * file, which `guides` fetches (null when nothing was drawn).
 * `sweep`: the sweep that the job is a point of. But for the finest, a job on its own may find another result.
 */
export function commands(job, process, origin, sweep = null) {
  const asked = askedFor(sweep ?? job, process);
  const name = sweep ? "sweep" : "decompose";
  const file = job.inputs?.mesh?.name || "mesh.obj";
  const options = asked.map(([name, value]) => `--${name.replaceAll("_", "-")} ${quoted(word(value))}`);
  const drawn = guidesOf(job);
  if (drawn) options.push(`--guides ${GUIDES}`);
  const url = quoted(`${origin}/api/v1/processes/${name}/execution?${queryOf(Object.fromEntries(asked))}`);
  const form = `-F ${quoted(`mesh=@${inForm(file)}`)} -F guides=@${GUIDES}`;
  return {
    guides: drawn ? `curl -o ${GUIDES} ${quoted(new URL(drawn, origin).href)}` : null,
    terminal: `sheetform ${name} ${quoted(file)} -o ${quoted(file.replace(/\.\w+$/, "") || "result")} ${options.join(" ")}`,
    curl: `curl ${drawn ? form : `--data-binary ${quoted(`@${file}`)}`} ${url}`,
  };
}

/** The address, and how it is looked at where the job itself says otherwise: whoever opens it elsewhere sees the same. */
function linkOf(job, view) {
  const more = new URLSearchParams(Object.entries(view).filter(([name, value]) => value && value !== job.parameters?.[name]));
  return [location.href.split("?")[0], String(more)].filter(Boolean).join("?");
}

/** changed(): another way is up, which the link tells. */
export function reproduce(job, process, { up, material }) {
  const source = job.reusedFrom ? jobs.get(job.reusedFrom) : null;
  const sweep = source && isSweep(source) ? source : null;
  const address = () => linkOf(job, { up: up(), material: material ?? materialOf().id });
  const link = copyRow("Link to this result", address());
  const { guides, terminal, curl } = commands(job, process, location.origin, sweep);
  const changed = () => (link.querySelector("code").textContent = address());
  const element = h(
    "details",
    { class: "more" },
    h("summary", {}, "Make it again"),
    link,
    guides && [
      h(
        "p",
        {},
        "What was drawn on the shape: ",
        h("a", { href: guidesOf(job), download: GUIDES }, GUIDES),
        ". The commands below want that file beside the mesh.",
      ),
      copyRow("Fetch it", guides),
    ],
    copyRow("On a terminal", terminal),
    copyRow("Over HTTP", curl),
    sweep && h("p", { class: "hint" }, `Among the results is this one: ${percent(job.parameters.e_max)}.`),
    job.inputs?.mesh?.sha256 &&
      h(
        "p",
        { class: "hint" },
        "The same mesh, parameters and version give the same bytes. Mesh: SHA-256 ",
        h("code", {}, job.inputs.mesh.sha256.slice(0, 16)),
        " …",
      ),
  );
  return { element, changed };
}

function copyRow(title, text) {
  const button = h(
    "button",
    {
      type: "button",
      class: "small right",
      onclick: async () => {
        try {
          await navigator.clipboard.writeText(code.textContent);
          button.textContent = "Copied";
          announce("Copied");
        } catch {
          getSelection().selectAllChildren(code);
        }
      },
    },
    "Copy",
  );
  const code = h("code", { class: "command", tabindex: "0", role: "group", "aria-label": title }, text);
  return h("div", { class: "copy-row" }, h("div", { class: "row" }, h("strong", {}, title), button), code);
}
