// What is certain of a result, in a maker's words. What the files alone can show is measured again here.
import { h } from "../dom.js";
import { millimetres, percent } from "../format.js";
import { countInner, measureSeams, measureStretch, partsThatCross } from "../result/checks.js";
import { icon } from "./icons.js";

/** Older results have no proof, only what was found. */
function nowhere({ hausdorff, hausdorff_at_most: proven }, mm) {
  return proven === undefined
    ? `Nowhere found farther than ${mm(hausdorff)}`
    : `Proven: nowhere farther than ${mm(proven)}`;
}

export function certificate(model) {
  const { report = {}, parameters = {}, input = {} } = model.layout;
  const stretch = measureStretch(model);
  const gap = measureSeams(model);
  const overlaps = partsThatCross(model);
  const met = report.e_max_met ?? report.hausdorff <= parameters.e_max;
  const mm = (fraction) => millimetres(fraction * (input.bbox_diagonal ?? 0) * model.scale);
  const inner = countInner(model);
  const rows = [
    [
      stretch.share <= 1e-6,
      "No stretch",
      `Each sheet only bends: no length changes by more than ${lengthText(stretch.absolute)}.`,
    ],
    [
      overlaps.length === 0,
      "No overlap",
      overlaps.length === 0
        ? "No outline crosses itself when the sheet lies flat."
        : `Outlines cross themselves: ${overlaps.join(", ")}.`,
    ],
    [
      gap <= 1e-3,
      "Matching seams",
      `Both sides of every seam are equally long, to ${lengthText(gap)}, and meet without a gap.`,
    ],
    [
      inner === 0,
      "Bends only",
      "Every bend line runs from edge to edge of its sheet; there is no point to press or stretch.",
    ],
    [
      met,
      met ? "Within tolerance" : "Tolerance not met",
      met
        ? `${nowhere(report, mm)} from your mesh, both ways (asked for: ${mm(parameters.e_max)}).`
        : `The worst place is ${mm(report.hausdorff)} off, ${percent(report.hausdorff)} of the diagonal; asked for was ${percent(parameters.e_max)}. Show “Error” in the 3D view to see where.`,
    ],
  ];
  const broken = rows.some(([good]) => !good);
  return h(
    "details",
    { class: "certificate", open: true },
    h(
      "summary",
      {},
      h("span", { class: broken ? "seal warn" : "seal" }, icon(broken ? "warn" : "check", 18)),
      "Certificate",
    ),
    h(
      "ul",
      {},
      rows.map(([good, title, text]) =>
        h(
          "li",
          { class: good ? "good" : "not" },
          h(
            "span",
            { class: "mark", "aria-label": good ? "holds" : "does not hold", role: "img" },
            icon(good ? "check" : "warn", 16),
          ),
          h("div", {}, h("strong", {}, title), h("p", { class: "hint" }, text)),
        ),
      ),
    ),
    h(
      "p",
      { class: "hint foot" },
      "The first four were measured again in this browser, from the files alone; the distance was measured by the server, which has your mesh.",
    ),
  );
}

function lengthText(mm) {
  if (mm < 1e-6) return "a nanometre";
  if (mm < 1e-3) return `${(mm * 1e6).toFixed(0)} nm`;
  return millimetres(mm);
}
