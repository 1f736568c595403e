// The curve of parts against error: every result of this mesh, and the sweep that fills the gaps. A point opens its result.
import { freshId, h, replace, s } from "../dom.js";
import { count, metres, millimetres, percent } from "../format.js";
import { ACTIVE, jobs } from "../jobs.js";
import { COSTS, curve, finishedOf, missingOf, relatives, stepOf, sweepOf, sweepTolerances } from "../result/trade_off.js";
import { startSweep } from "../variants.js";
import { problemBox } from "./problem.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP] = [332, 196, 34, 30, 24];

export function tradeOff(job, scale, stops) {
  const chart = h("div", {});
  const controls = h("div", { class: "trade-off-controls" });
  const note = h("div", {});
  let sending = false;
  let measure = "parts";
  let drawn = [];
  /** Draws anew only what concerns this mesh: what others do shall not take a point from under the pointer. */
  const update = () => {
    const mine = jobs.get(job.jobID) ?? job;
    const all = relatives(mine, jobs.newestFirst());
    const now = [measure, sending, ...all];
    if (now.length === drawn.length && now.every((part, k) => part === drawn[k])) return;
    drawn = now;
    const focus = document.activeElement?.getAttribute?.("href");
    const held = chart.contains(document.activeElement);
    replace(chart, draw(curve(mine, all, measure), mine, scale, measure));
    if (held) chart.querySelector(`a[href="${focus}"]`)?.focus();
    const sweep = sweepOf(mine, all);
    const missing = missingOf(mine, all);
    if (sweep && ACTIVE.has(sweep.status)) showProgress(controls, sweep, note);
    else if (missing.length > 0) replace(controls, missingButton(missing, diagonalOf(mine, scale), sending, start));
    else if (sweep) replace(controls, h("p", { class: "hint" }, "Every point is a result. Choose one to see it."));
    else replace(controls, startButton(sweepTolerances(mine), sending, start));
  };
  async function start(tolerances) {
    sending = true;
    update();
    try {
      await startSweep(job, tolerances);
      replace(note);
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

function startButton(tolerances, sending, start) {
  return [
    h("button", { type: "button", disabled: sending, onclick: () => start(tolerances) }, "Compare tolerances"),
    h(
      "p",
      { class: "hint" },
      `Also makes it for ${tolerances.length} tolerances from coarse to fine. Then choose a point.`,
    ),
  ];
}

/** A sweep ended early, by wish or because its time ran out: what it found is there, the rest can be asked for. */
function missingButton(missing, diagonal, sending, start) {
  const words = missing.map((e_max) => (diagonal ? millimetres(e_max * diagonal) : percent(e_max)));
  const rest = [words.slice(0, -1).join(", "), words.at(-1)].filter(Boolean).join(" and ");
  return [
    h("p", { class: "hint" }, `Every point is a result. Not made: ${rest}.`),
    h(
      "button",
      { type: "button", disabled: sending, onclick: () => start(missing) },
      missing.length === 1 ? "Make the missing one" : `Make the ${missing.length} missing ones`,
    ),
  ];
}

/** The bar stays the same element while it grows. */
function showProgress(controls, sweep, note) {
  let bar = controls.querySelector("progress");
  if (!bar) {
    bar = h("progress", { max: "100", "aria-label": "Comparing tolerances" });
    replace(controls, h("p", { class: "busy" }), h("div", { class: "row sweeping" }, bar), stopButton(sweep, note));
  }
  bar.value = sweep.progress;
  controls.querySelector(".busy").textContent = `Comparing tolerances … ${stepOf(sweep)}`;
  controls.querySelector(".stop").textContent = wordsOfStop(sweep);
}

/** What a stop would do, said before: points that are finished are kept. */
export function wordsOfStop(sweep) {
  const done = finishedOf(sweep);
  return done > 0 ? `Stop, keep the ${done === 1 ? "one" : done} finished` : "Stop";
}

/** Stops a sweep: with what it has found, or, when that is nothing, for good. */
export function stopButton(sweep, note, look = "small") {
  const stop = async () => {
    const now = jobs.get(sweep.jobID) ?? sweep;
    button.disabled = true;
    try {
      await (finishedOf(now) > 0 ? jobs.finish(now.jobID) : jobs.dismiss(now.jobID));
    } catch (error) {
      button.disabled = false;
      replace(note, problemBox(error));
    }
  };
  const button = h("button", { type: "button", class: `stop ${look}`, onclick: stop }, wordsOfStop(sweep));
  return button;
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

/** In millimetres; 0 when it is not known. */
const diagonalOf = (job, scale) => (job.inputs?.mesh?.bboxDiagonal ?? 0) * scale;

function draw(points, job, scale, measure) {
  if (points.length === 0) return h("p", { class: "hint" }, "The curve appears with the first result.");
  const diagonal = diagonalOf(job, scale);
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
    ticks(most, measure === "parts" ? 1 : 0).map((n) => [
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
    points.map((p) => point(p, x(p.error), y(p.cost * unit), diagonal)),
  );
}

/** Five values at most, from 0; `least` is the smallest step that makes sense. */
function ticks(most, least) {
  const steps = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
  const step = steps.find((n) => n >= least && most / n <= 5) ?? 1000;
  return Array.from({ length: Math.floor((most * 1.08) / step) + 1 }, (_, k) => Number((k * step).toFixed(1)));
}

/** A result in words: parts, length to cut, deviation; `diagonal` in mm, 0 when the size is not known. */
function wordsOfPoint({ report, effort }, diagonal) {
  return [
    count(report.patches, "part"),
    diagonal && `${metres(COSTS.cut(report) * diagonal)} to cut`,
    `within ${diagonal ? millimetres(report.hausdorff * diagonal) : percent(report.hausdorff)}`,
    effort === "draft" && "quick draft",
  ]
    .filter(Boolean)
    .join(", ");
}

function point(p, x, y, diagonal) {
  const text = wordsOfPoint(p, diagonal);
  return s(
    "a",
    { href: p.href, "aria-label": p.own ? `${text}, shown now` : text, "aria-current": p.own ? "true" : null },
    s("title", {}, text),
    s("circle", { class: "hit", cx: x, cy: y, r: 13 }),
    s("circle", { class: p.best ? "point best" : "point", cx: x, cy: y, r: p.own ? 7 : 5 }),
  );
}
