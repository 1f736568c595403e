// Below the 3D view: what the colours mean, what is drawn, parts moved apart, sheets folded open.
import { freshId, h, replace } from "../dom.js";
import { millimetres, significant } from "../format.js";
import { bendColors } from "../result/bend.js";
import { compareWith } from "../worker/client.js";
import { heatColor } from "../view/theme.js";
import { icon } from "./icons.js";

export function viewControls({ stage, model, mesh, material }) {
  const state = { color: "parts", seams: true, rulings: true, original: false };
  const legend = h("div", { class: "legend", hidden: true });
  const apart = slider("Apart", (value) => stage.pose({ explode: value }));
  const fold = slider("Unfold", (value) => stage.pose({ fold: 1 - value }));
  let running = 0;
  const play = h(
    "button",
    {
      type: "button",
      class: "tool",
      title: "Unfold and fold",
      "aria-label": "Unfold and fold",
      onclick: () => animate(),
    },
    icon("play", 18),
  );

  function animate() {
    cancelAnimationFrame(running);
    const from = Number(fold.input.value);
    const to = from > 0.5 ? 0 : 1;
    const begun = performance.now();
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    const next = (now) => {
      const t = calm ? 1 : Math.min(1, (now - begun) / 2600);
      const eased = t * t * (3 - 2 * t);
      fold.set(from + (to - from) * eased);
      if (t < 1) running = requestAnimationFrame(next);
    };
    running = requestAnimationFrame(next);
  }
  const draw = () => {
    stage.result?.show(state);
    stage.flat?.showRulings(state.rulings);
    if (stage.input) stage.input.group.visible = state.original || state.color === "error" || state.color === "tilt";
    if (stage.drawn) stage.drawn.group.visible = state.original;
    stage.viewport?.draw();
  };
  const toggle = (name, title) =>
    h(
      "label",
      { class: "toggle" },
      h("input", {
        type: "checkbox",
        checked: state[name],
        onchange: async (event) => {
          state[name] = event.target.checked;
          if (name === "original") await ensureInput();
          draw();
        },
      }),
      h("span", {}, title),
    );

  async function ensureInput() {
    if (stage.input) return true;
    const input = await mesh();
    if (!input || !stage.result || stage.input) return Boolean(stage.input);
    stage.addOverlay(input);
    return true;
  }
  const colors = { parts: showParts, error: () => showHeat("error"), tilt: () => showHeat("tilt"), bend: showBend };
  function showParts() {
    legend.hidden = true;
    stage.result.setValues(null);
    if (stage.input) {
      stage.input.setHeat(null);
      stage.input.markPlaces([]);
      stage.input.asGhost(true);
    }
    stage.result.group.visible = true;
  }
  async function showHeat(kind) {
    if (!(await ensureInput())) return (replace(legend, "The mesh could not be fetched."), (legend.hidden = false));
    const heat = (await comparison(stage, model))[kind];
    if (state.color !== kind) return;
    stage.input.setHeat(heat.values, heat.full);
    stage.input.asGhost(false);
    stage.input.box.visible = stage.input.borders.visible = stage.input.crowded.visible = false;
    stage.input.markPlaces([heat.place]);
    stage.result.group.visible = false;
    showLegend(legend, heat);
  }
  function showBend() {
    const { values, tightest, text } = bendColors(model, material);
    stage.result.setValues(values);
    stage.result.group.visible = true;
    replace(
      legend,
      h("strong", {}, `Bend radius in ${material.title.toLowerCase()}`),
      h(
        "div",
        { class: "keys" },
        h("span", { class: "key ok" }, "easy"),
        h("span", { class: "key near" }, "tight"),
        h("span", { class: "key over" }, `below ${material.radius} mm`),
      ),
      h("span", { class: "hint" }, Number.isFinite(tightest) ? `Tightest: about ${significant(tightest, 2)} mm. ${text}` : text),
    );
    legend.hidden = false;
  }
  const name = freshId("color");
  const choose = async (id) => {
    state.color = id;
    showParts();
    // What concerns the sheets does nothing while the mesh is shown in their place.
    for (const row of ofSheets) row.disabled = id === "error" || id === "tilt";
    await colors[id]();
    draw();
  };
  const segments = h(
    "div",
    { class: "segments small", role: "radiogroup", "aria-label": "Colours show" },
    [
      ["parts", "Parts"],
      ["error", "Error"],
      ["tilt", "Tilt"],
      ["bend", "Bend"],
    ].map(([id, title]) =>
      h(
        "label",
        {},
        h("input", { type: "radio", name, value: id, checked: id === "parts", onchange: () => choose(id) }),
        h("span", {}, title),
      ),
    ),
  );
  draw();
  const ofSheets = [
    h(
      "fieldset",
      { class: "toggles", "aria-label": "Shown" },
      toggle("seams", "Seams"),
      toggle("rulings", "Bend lines"),
      toggle("original", "Your mesh"),
    ),
    h("fieldset", { class: "control-row", "aria-label": "Pose" }, apart.element, fold.element, play),
  ];
  const element = h(
    "div",
    { class: "view-controls" },
    legend,
    h(
      "div",
      { class: "control-row" },
      segments,
      ofSheets[0],
    ),
    ofSheets[1],
  );
  /** Colours as if chosen here. */
  const show = (id) => {
    const radio = segments.querySelector(`input[value=${id}]`);
    if (!radio.checked) radio.click();
  };
  return { element, show, dispose: () => cancelAnimationFrame(running) };
}

function slider(title, onValue) {
  const id = freshId("slider");
  const input = h("input", {
    type: "range",
    id,
    min: "0",
    max: "1",
    step: "0.005",
    value: "0",
    oninput: () => onValue(Number(input.value)),
  });
  return {
    input,
    element: h("label", { class: "slider", for: id }, h("span", {}, title), input),
    set: (value) => {
      input.value = String(value);
      onValue(value);
    },
  };
}

/** Distance (mm) and tilt (degrees) of the input's vertices against the sheets, computed once per model. */
async function comparison(stage, model) {
  if (model.comparison) return model.comparison;
  const { mesh } = stage.input;
  const shift = mesh.center.map((value, axis) => value - model.center[axis]);
  const vertices = Float64Array.from(mesh.positions, (value, k) => value + shift[k % 3]);
  const faces = Uint32Array.from(model.parts.flatMap((part) => Array.from(part.triangles)));
  const { distances, tilts } = await compareWith(vertices, mesh.indices, model.position, faces);
  model.comparison = {
    error: errorHeat(
      distances.map((value) => value * model.scale),
      mesh,
      model.layout,
      model.scale,
    ),
    tilt: tiltHeat(tilts, mesh),
  };
  return model.comparison;
}

const worstOf = (values) => values.reduce((best, value, v) => (value > values[best] ? v : best), 0);
const pointOf = (mesh, v) => Array.from(mesh.positions.slice(3 * v, 3 * v + 3));

/**
 * Colours are distances of the mesh's vertices to the sheets; the worst place is the server's, who looked between the
 * vertices, and the other way round, too (older results do not tell it).
 */
function errorHeat(values, mesh, { input = {}, parameters = {}, report = {} }, scale) {
  const mm = (fraction) => (fraction ?? 0) * (input.bbox_diagonal ?? 0) * scale;
  const at = worstOf(values);
  const told = report.worst_place;
  const most = told ? mm(report.hausdorff) : values[at];
  const side = told && report.result_to_input > report.input_to_result ? " from a sheet to your mesh" : "";
  return {
    values,
    place: told ? told.map((value, axis) => value - mesh.center[axis]) : pointOf(mesh, at),
    full: Math.max(mm(parameters.e_max), most),
    title: "Distance of your mesh to the sheets",
    unit: millimetres,
    text: `Worst place (marked): ${millimetres(most)}${side}. Allowed: ${millimetres(mm(parameters.e_max))}.`,
  };
}

/** The scale ends where few values lie above: a single fold in the mesh shall not hide all the rest. */
function tiltHeat(values, mesh) {
  const at = worstOf(values);
  const full = Math.max(30, Float64Array.from(values).sort()[Math.floor(0.98 * (values.length - 1))]);
  return {
    values,
    place: pointOf(mesh, at),
    full,
    over: values[at] > full,
    title: "Tilt of the sheets against your mesh",
    unit: degrees,
    text: `Largest (marked): ${degrees(values[at])}. High values show where light will fall differently.`,
  };
}

const degrees = (value) => `${Math.round(value)}°`;

function showLegend(legend, { title, full, over = false, unit, text }) {
  const canvas = h("canvas", { width: 200, height: 8, class: "ramp", "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  for (let x = 0; x < 200; x++) {
    const [r, g, b] = heatColor(x / 199).map((value) => Math.round(255 * value));
    context.fillStyle = `rgb(${r} ${g} ${b})`;
    context.fillRect(x, 0, 1, 8);
  }
  replace(
    legend,
    h("strong", {}, title),
    canvas,
    h("div", { class: "slider-ends" }, h("span", {}, unit(0)), h("span", {}, over ? `${unit(full)} and more` : unit(full))),
    h("span", { class: "hint" }, text),
  );
  legend.hidden = false;
}
