// The same result again: a link to it, and the commands that make it on a terminal.
import { queryOf } from "../api.js";
import { announce, h } from "../dom.js";

/** Parameters of a job that differ from the defaults of the schema, as [name, value] pairs. */
export function askedFor(job, process) {
  return Object.entries(job.parameters ?? {}).filter(([name, value]) => {
    const fallback = process.inputs[name]?.schema?.default;
    return value !== null && (name === "e_max" || JSON.stringify(value) !== JSON.stringify(fallback));
  });
}

const word = (value) => (value === true ? "on" : value === false ? "off" : String(value));
const quoted = (text) => (/^[\w./,:=+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

export function commands(job, process, origin) {
  const asked = askedFor(job, process);
  const file = job.inputs?.mesh?.name || "mesh.obj";
  const options = asked.map(([name, value]) => `--${name.replaceAll("_", "-")} ${quoted(word(value))}`).join(" ");
  return {
    terminal: `sheetform decompose ${quoted(file)} -o ${quoted(file.replace(/\.\w+$/, "") || "result")} ${options}`,
    curl: `curl --data-binary @${quoted(file)} ${quoted(`${origin}/api/v1/processes/decompose/execution?${queryOf(Object.fromEntries(asked))}`)}`,
  };
}

export function reproduce(job, process) {
  const { terminal, curl } = commands(job, process, location.origin);
  return h(
    "details",
    { class: "more" },
    h("summary", {}, "Make it again"),
    copyRow("Link to this result", location.href),
    copyRow("On a terminal", terminal),
    copyRow("Over HTTP", curl),
    job.inputs?.mesh?.sha256 &&
      h(
        "p",
        { class: "hint" },
        "The same mesh, parameters and version give the same bytes. Mesh: SHA-256 ",
        h("code", {}, job.inputs.mesh.sha256.slice(0, 16)),
        " …",
      ),
  );
}

function copyRow(title, text) {
  const button = h(
    "button",
    {
      type: "button",
      class: "small right",
      onclick: async () => {
        try {
          await navigator.clipboard.writeText(text);
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
