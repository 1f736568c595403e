// The figures of a result that a maker asks for first.
import { h } from "../dom.js";
import { area, count, duration, metres, millimetres, percent } from "../format.js";

export function figures(model, job) {
  const { report = {}, input = {}, parameters = {} } = model.layout;
  const mm = (fraction) => fraction * (input.bbox_diagonal ?? 0) * model.scale;
  const cut = model.seams.reduce((sum, seam) => sum + seam.length * (seam.border ? 1 : 2), 0);
  const glue = model.seams.reduce((sum, seam) => sum + (seam.border ? 0 : seam.length), 0);
  const seconds = job.started && job.finished ? (new Date(job.finished) - new Date(job.started)) / 1000 : null;
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
    (report.notes ?? []).length > 0 &&
      h(
        "details",
        { class: "notes" },
        h("summary", {}, count(report.notes.length, "note")),
        h(
          "ul",
          {},
          report.notes.map((note) => h("li", { class: "hint" }, note)),
        ),
      ),
  );
}
