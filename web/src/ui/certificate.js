// What is certain of a result, in a maker's words. Two of the promises are measured again here, from the files alone.
import { h } from "../dom.js";
import { millimetres, percent } from "../format.js";
import { icon } from "./icons.js";

export function certificate(model, job) {
  const { report = {}, parameters = {}, input = {} } = model.layout;
  const stretch = measureStretch(model);
  const met = report.e_max_met ?? report.hausdorff <= parameters.e_max;
  const mm = (fraction) => millimetres(fraction * (input.bbox_diagonal ?? 0) * model.scale);
  const inner = countInner(model);
  const rows = [
    [stretch.share <= 1e-6, "No stretch", `Each sheet only bends. The largest change of any length is ${lengthText(stretch.absolute)}, measured again in this browser.`],
    [true, "No overlap", "No sheet covers itself when it lies flat."],
    [true, "Closed seams", "Both sides of every seam are the same line in space, so their lengths are equal and nothing gapes."],
    [inner === 0, "No inner corners", "Every bend line runs from edge to edge of its sheet."],
    [met, met ? "Within tolerance" : "Tolerance not met", met
      ? `Nowhere farther than ${mm(report.hausdorff)} from your mesh, measured both ways (asked for: ${mm(parameters.e_max)}).`
      : `The worst place is ${mm(report.hausdorff)} off, ${percent(report.hausdorff)} of the diagonal; asked for was ${percent(parameters.e_max)}. Show “Error” in the 3D view to see where.`],
  ];
  const broken = rows.some(([good]) => !good);
  return h("details", { class: "certificate", open: true },
    h("summary", {}, h("span", { class: broken ? "seal warn" : "seal" }, icon(broken ? "warn" : "check", 18)), "Certificate"),
    h("ul", {}, rows.map(([good, title, text]) => h("li", { class: good ? "good" : "not" },
      h("span", { class: "mark", "aria-label": good ? "holds" : "does not hold", role: "img" }, icon(good ? "check" : "warn", 16)), h("div", {}, h("strong", {}, title), h("p", { class: "hint" }, text))))));
}

function lengthText(mm) {
  if (mm < 1e-6) return "below a nanometre";
  if (mm < 1e-3) return `${(mm * 1e6).toFixed(0)} nm`;
  return millimetres(mm);
}

/** Largest difference between an edge in space and on the sheet, in mm and as a share of its part's size. */
export function measureStretch({ parts, position, flat, scale }) {
  let [absolute, share] = [0, 0];
  for (const part of parts) {
    const size = Math.hypot(part.box[2] - part.box[0], part.box[3] - part.box[1]) || 1;
    for (let k = 0; k < part.triangles.length; k++) {
      const [a, b] = [part.triangles[k], part.triangles[k % 3 === 2 ? k - 2 : k + 1]];
      const solid = Math.hypot(position[3 * a] - position[3 * b], position[3 * a + 1] - position[3 * b + 1], position[3 * a + 2] - position[3 * b + 2]) * scale;
      const difference = Math.abs(solid - Math.hypot(flat[2 * a] - flat[2 * b], flat[2 * a + 1] - flat[2 * b + 1]));
      absolute = Math.max(absolute, difference);
      share = Math.max(share, difference / size);
    }
  }
  return { absolute, share };
}

/** Vertices of sheets that are not on their outline. */
function countInner({ parts }) {
  return parts.reduce((sum, part) => sum + (part.end - part.begin) - new Set(part.outline).size, 0);
}
