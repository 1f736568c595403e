// The figures of a result that a maker asks for first, and what the program noticed on the way.
import { h } from "../dom.js";
import { area, count, duration, metres, millimetres, percent } from "../format.js";
import { bendColors } from "../result/bend.js";
import { isTiny } from "../result/parse_result.js";
import { repairsOf } from "../result/places.js";
import { icon } from "./icons.js";

const FEW = 3; // notes that are read at once

/** @param showPlaces(points) marks places in the 3D view  @param showColours(by) colours it by "error" or "bend" */
export function figures(model, job, material, { showPlaces, showColours }) {
  const { report = {}, input = {}, parameters = {} } = model.layout;
  const mm = (fraction) => fraction * (input.bbox_diagonal ?? 0) * model.scale;
  const cut = model.seams.reduce((sum, seam) => sum + seam.length * (seam.border ? 1 : 2), 0);
  const glue = model.seams.reduce((sum, seam) => sum + (seam.border ? 0 : seam.length), 0);
  const seconds =
    job.started && job.finished && !job.reusedFrom ? (new Date(job.finished) - new Date(job.started)) / 1000 : null;
  const rows = [
    ["Parts", String(model.parts.length)],
    [
      "Largest deviation",
      millimetres(mm(report.hausdorff)),
      `${percent(report.hausdorff)} of the diagonal; asked for ${percent(parameters.e_max)}`,
    ],
    ["On average", millimetres(mm(report.mean_distance))],
    ["To cut", metres(cut), "the outlines of all parts"],
    ["To join", metres(glue), "seams, each once"],
    ["Material", area(model.parts.reduce((sum, part) => sum + part.area, 0)), "area of all parts"],
  ];
  return h(
    "section",
    {},
    h(
      "dl",
      { class: "figures" },
      rows.map(([name, value, hint], k) =>
        h(
          "div",
          { class: k === 0 ? "figure big" : "figure", title: hint ?? null },
          h("dt", {}, name),
          h("dd", {}, value),
        ),
      ),
    ),
    missed(report, parameters, (fraction) => millimetres(mm(fraction)), () => showColours("error")),
    bends(model, material, () => showColours("bend")),
    tiny(model),
    seconds !== null && h("p", { class: "hint" }, `Computed in ${duration(seconds)}.`),
    notes(model, showPlaces),
  );
}

/** Nobody shall cut what is not as close as was asked for without having read it. */
function missed({ e_max_met: met, hausdorff }, { e_max }, mm, showError) {
  if (met ?? hausdorff <= e_max) return null;
  return h(
    "div",
    { class: "bends long warning" },
    icon("warn", 16),
    h(
      "span",
      {},
      h("strong", {}, "Tolerance missed. "),
      `The worst place is ${mm(hausdorff)} off, ${mm(e_max)} were asked for. Allow more, or run again with more effort.`,
    ),
    h("button", { type: "button", class: "small right", onclick: showError }, "Show where"),
  );
}

/** Slivers come from flaws of the mesh, or from details smaller than the tolerance wants to see. */
function tiny({ parts }) {
  const names = parts.filter(isTiny).map(({ label }) => label);
  if (names.length === 0) return null;
  const some = names.length > 6 ? [...names.slice(0, 5), "…"] : names;
  return h(
    "p",
    { class: "bends" },
    icon("info", 16),
    h(
      "span",
      {},
      `${count(names.length, "part is", "parts are")} hardly wide enough to cut (${some.join(", ")}). A larger size or tolerance has fewer.`,
    ),
  );
}

/** Whether the material can do it: said before the sheets are cut. */
function bends(model, material, showBends) {
  const { easy, text } = bendColors(model, material);
  const name = material.title.toLowerCase();
  const show = h("button", { type: "button", class: "small right", onclick: showBends }, "Show bends");
  if (easy > 0.995)
    return h("p", { class: "bends" }, icon("check", 16), h("span", {}, `Bends easily in ${name}.`), show);
  return h(
    "div",
    { class: easy < 0.9 ? "bends warning" : "bends" },
    icon(easy < 0.9 ? "warn" : "info", 16),
    h("span", { title: text }, `${percent(1 - easy, 0)} of the sheets bend tighter than ${name} likes.`),
    show,
  );
}

/** Repairs and what else there is to say; where something can be seen, a button shows it. */
function notes(model, showPlaces) {
  const { report = {} } = model.layout;
  if (!report.notes?.length) return null;
  const places = new Map(repairsOf(model.layout, model.center).map((repair) => [repair.text, repair.places]));
  const buttons = [];
  const show = (button, note) => {
    const on = button.getAttribute("aria-pressed") !== "true";
    for (const other of buttons) other.setAttribute("aria-pressed", String(on && other === button));
    showPlaces(on ? places.get(note) : []);
  };
  return h(
    "details",
    { class: "notes", open: places.size > 0 || report.notes.length <= FEW },
    h("summary", {}, count(report.notes.length, "note")),
    h(
      "ul",
      {},
      report.notes.map((note) => {
        if (!places.has(note)) return h("li", { class: "hint" }, note);
        const button = h(
          "button",
          {
            type: "button",
            class: "small",
            "aria-pressed": "false",
            "aria-label": `Show where: ${note}`,
            onclick: () => show(button, note),
          },
          "Show where",
        );
        buttons.push(button);
        return h("li", { class: "hint" }, note, " ", button);
      }),
    ),
  );
}
