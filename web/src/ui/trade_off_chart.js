// The curve of parts against error: every result of this mesh, and a sweep that fills the gaps. A point opens its result.
import { freshId, h, replace, s } from "../dom.js";
import { count, metres, millimetres, percent } from "../format.js";
import { ACTIVE, jobs } from "../jobs.js";
import { COSTS, curve, missing, relatives } from "../result/trade_off.js";
import { startVariants } from "../variants.js";
import { problemBox } from "./problem.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP] = [332, 196, 34, 30, 24];

export function tradeOff(job, scale, stops) {
  const chart = h("div", {});
  const controls = h("div", { class: "row" });
  const note = h("div", {});
  let sending = false;
  let measure = "parts";
  const update = () => {
    const all = jobs.newestFirst();
    const mine = jobs.get(job.jobID) ?? job;
    const focus = document.activeElement?.getAttribute?.("href");
    const held = chart.contains(document.activeElement);
    replace(chart, draw(curve(mine, all, measure), mine, scale, measure));
    if (held) chart.querySelector(`a[href="${focus}"]`)?.focus();
    const active = relatives(mine, all).filter((other) => ACTIVE.has(other.status)).length;
    const wanted = missing(mine, all);
    replace(
      controls,
      active > 0
        ? h("p", { class: "busy" }, `${count(active, "result")} on the way …`)
        : wanted.length > 0 &&
            h("button", { type: "button", disabled: sending, onclick: () => sweep(wanted) }, "Try other tolerances"),
    );
  };
  async function sweep(tolerances) {
    sending = true;
    update();
    try {
      await startVariants(
        job,
        tolerances.map((e_max) => ({ e_max, effort: "draft" })),
      );
    } catch (error) {
      replace(note, problemBox(error));
    }
    sending = false;
    update();
  }
  stops.push(jobs.onChange(update));
  update();
  const choose = (id) => {
    measure = id;
    update();
  };
  return h(
    "section",
    { class: "trade-off" },
    h("h2", {}, "Fewer parts, or closer?"),
    measures(choose),
    chart,
    controls,
    note,
  );
}

function measures(choose) {
  const name = freshId("measure");
  return h(
    "div",
    { class: "segments small", role: "radiogroup", "aria-label": "The curve shows" },
    [
      ["parts", "Parts"],
      ["cut", "Length to cut"],
    ].map(([value, title]) =>
      h(
        "label",
        {},
        h("input", { type: "radio", name, value, checked: value === "parts", onchange: () => choose(value) }),
        h("span", {}, title),
      ),
    ),
  );
}

function draw(points, job, scale, measure) {
  if (points.length === 0) return h("p", { class: "hint" }, "The curve appears with the first result.");
  const diagonal = (job.inputs?.mesh?.bboxDiagonal ?? 0) * scale;
  // Lengths in metres of the finished object, or in diagonals where the size is not known.
  const unit = measure === "cut" && diagonal ? diagonal / 1000 : 1;
  const most = Math.max(...points.map((p) => p.cost * unit), measure === "parts" ? 2 : 0);
  const widest = Math.max(...points.map((p) => p.error), 0.01) * 1.08;
  const x = (error) => LEFT + ((WIDTH - LEFT - 12) * error) / widest;
  const y = (cost) => HEIGHT - BOTTOM - ((HEIGHT - BOTTOM - TOP) * cost) / (most * 1.08);
  const best = points.filter((p) => p.best);
  const line = best.map((p, k) => `${k === 0 ? `M${x(p.error)} ` : `H${x(p.error)}V`}${y(p.cost * unit)}`).join("");
  return s(
    "svg",
    {
      class: "chart",
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      role: "group",
      "aria-label": `${measure === "parts" ? "Parts" : "Length to cut"} against largest deviation`,
    },
    ticks(most).map((n) => [
      s("path", { class: "grid", d: `M${LEFT} ${y(n)}H${WIDTH - 12}` }),
      s("text", { x: LEFT - 7, y: y(n), "text-anchor": "end", "dominant-baseline": "central" }, n),
    ]),
    s("text", { x: LEFT, y: HEIGHT - 10 }, "0"),
    s(
      "text",
      { x: WIDTH - 12, y: HEIGHT - 10, "text-anchor": "end" },
      `${diagonal ? millimetres(widest * diagonal) : percent(widest)} deviation`,
    ),
    s("text", { x: 6, y: 14 }, measure === "parts" ? "parts" : diagonal ? "metres to cut" : "diagonals to cut"),
    s("path", { class: "steps", d: line }),
    points.map((p) => point(p, job, x(p.error), y(p.cost * unit), diagonal)),
  );
}

function ticks(most) {
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].find((n) => most / n <= 5) ?? 1000;
  return Array.from({ length: Math.floor((most * 1.08) / step) + 1 }, (_, k) => Number((k * step).toFixed(1)));
}

function point(p, job, x, y, diagonal) {
  const own = p.job.jobID === job.jobID;
  const { report, parameters } = p.job;
  const text = [
    count(report.patches, "part"),
    diagonal && `${metres(COSTS.cut(report) * diagonal)} to cut`,
    `within ${diagonal ? millimetres(p.error * diagonal) : percent(p.error)}`,
    parameters?.effort === "draft" && "quick draft",
  ]
    .filter(Boolean)
    .join(", ");
  return s(
    "a",
    {
      href: `#job/${p.job.jobID}`,
      "aria-label": own ? `${text}, shown now` : text,
      "aria-current": own ? "true" : null,
    },
    s("title", {}, text),
    s("circle", { class: "hit", cx: x, cy: y, r: 13 }),
    s("circle", { class: p.best ? "point best" : "point", cx: x, cy: y, r: own ? 7 : 5 }),
  );
}
