// The figures of a result that a maker asks for first, and what the program noticed on the way.
import { h } from "../dom.js";
import { area, count, duration, metres, millimetres, percent } from "../format.js";
import { repairsOf } from "../result/places.js";

/** @param showPlaces(points, of what) marks places in the 3D view */
export function figures(model, job, showPlaces) {
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
    seconds !== null && h("p", { class: "hint" }, `Computed in ${duration(seconds)}.`),
    notes(model, showPlaces),
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
    { class: "notes", open: places.size > 0 },
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
