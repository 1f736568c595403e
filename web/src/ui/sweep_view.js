// A finished sweep: the curve, and the same points as a list; each opens its result.
import { h } from "../dom.js";
import { metres, millimetres, percent } from "../format.js";
import { titleOf } from "../jobs.js";
import { COSTS } from "../result/trade_off.js";
import { scaleOf } from "../variants.js";
import { fileHead } from "./file_head.js";
import { removeButton } from "./remove_button.js";
import { tradeOff } from "./trade_off_chart.js";

/** @param actions {runAgain(), remove()} */
export function sweepView(job, stops, { runAgain, remove }) {
  const scale = scaleOf(job);
  const diagonal = (job.inputs?.mesh?.bboxDiagonal ?? 0) * scale;
  const rows = (job.report?.curve ?? []).map((report) =>
    h(
      "tr",
      {},
      h(
        "th",
        { scope: "row" },
        h("a", { href: `#job/${job.jobID}/${report.point}` }, diagonal ? millimetres(report.e_max * diagonal) : ""),
        h("span", { class: "hint" }, ` ${percent(report.e_max)}`),
      ),
      h("td", {}, String(report.patches)),
      h("td", {}, diagonal ? metres(COSTS.cut(report) * diagonal) : ""),
      h(
        "td",
        { class: report.e_max_met ? null : "missed" },
        diagonal ? millimetres(report.hausdorff * diagonal) : percent(report.hausdorff),
      ),
    ),
  );
  return [
    fileHead(titleOf(job)),
    h("p", {}, "The same shape within several tolerances, each with files of its own."),
    tradeOff(job, scale, stops),
    h(
      "table",
      { class: "points" },
      h("thead", {}, h("tr", {}, ["Tolerance", "Parts", "To cut", "Deviation"].map((name) => h("th", {}, name)))),
      h("tbody", {}, rows),
    ),
    h(
      "div",
      { class: "row" },
      h("button", { type: "button", onclick: runAgain }, "Run again with …"),
      removeButton("Remove job", remove),
    ),
  ];
}
