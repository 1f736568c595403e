// The list of parts: choose one here, and it lights up in both views; its seams and what they join.
import { h, replace } from "../dom.js";
import { area, count, extent, millimetres } from "../format.js";
import { BEND_STEP, isTiny } from "../result/parse_result.js";

export function partsList(model, stage, material, stops) {
  const rows = model.parts.map((part, k) => row(model, stage, part, k, material));
  const list = h(
    "div",
    {
      class: "parts",
      role: "listbox",
      tabindex: "0",
      "aria-label": "Parts",
      onkeydown: (event) => onKey(event, model, stage),
    },
    rows,
  );
  const detail = h("div", { class: "part-detail" });
  const update = ({ hovered, selected, seam }) => {
    rows.forEach((element, k) => {
      element.setAttribute("aria-selected", String(selected === k));
      element.classList.toggle("lit", hovered === k);
    });
    if (selected !== null) {
      list.setAttribute("aria-activedescendant", rows[selected].id);
      rows[selected].scrollIntoView({ block: "nearest" });
    }
    replace(
      detail,
      selected !== null
        ? partDetail(model, stage, selected)
        : seam !== null
          ? seamDetail(model, stage, seam)
          : h("p", { class: "hint" }, "Choose a part here or in a view. Seams can be chosen too."),
    );
  };
  stops.push(stage.onSelection(update));
  update(stage.selection);
  const mirrored = model.parts.filter((part) => part.mirrorOf !== null).length;
  return h(
    "div",
    {},
    mirrored > 0 &&
      h(
        "p",
        { class: "hint" },
        `${count(mirrored, "part is the mirror image", "parts are mirror images")} of another: the same outline, turned over.`,
      ),
    model.parts.length > FEW && finder(model, stage),
    detail,
    list,
  );
}

const FEW = 6; // parts that are found at a glance

/** Who holds a part types what is printed on it, or the number of a seam, and sees where it belongs. */
function finder(model, stage) {
  const note = h("p", { class: "field-error", role: "status" });
  const find = (text) => {
    const wanted = text.trim().toUpperCase();
    const part = model.parts.findIndex(({ label }) => label.toUpperCase() === wanted);
    const seam = model.seams.find(({ name }) => name.toUpperCase() === wanted);
    if (part >= 0) stage.setSelection({ selected: part, seam: null });
    else if (seam) stage.setSelection({ selected: null, seam: seam.id });
    return part >= 0 || seam || wanted === "";
  };
  const input = h("input", {
    type: "search",
    "aria-label": "Find a part or a seam",
    placeholder: `Find: ${model.parts[0].label}, or the number of a seam`,
    oninput: () => find(input.value) && (note.textContent = ""),
    onchange: () => (note.textContent = find(input.value) ? "" : `Nothing here is called ${input.value.trim()}.`),
  });
  return h("div", { class: "finder" }, input, note);
}

function row(model, stage, part, k, material) {
  const [w, d] = [part.box[2] - part.box[0], part.box[3] - part.box[1]];
  const large = !fits(w, d, material.sheet);
  return h(
    "div",
    {
      class: "part-row",
      role: "option",
      id: `part-row-${k}`,
      "aria-selected": "false",
      onclick: () => stage.choose({ part: k, seam: null }),
      onpointerenter: () => stage.hover({ part: k, seam: null }),
      onpointerleave: () => stage.hover({ part: null, seam: null }),
    },
    h("span", { class: `swatch color-${model.colors[k]}`, "aria-hidden": "true" }),
    h("strong", {}, part.label),
    h("span", { class: "hint" }, extent(w, d)),
    h("span", { class: "hint right" }, area(part.area)),
    part.mirrorOf !== null && h("span", { class: "tag" }, `mirror of ${labelOf(model, part.mirrorOf)}`),
    isTiny(part) && h("span", { class: "tag warn", title: "Hardly to be cut or held" }, "tiny"),
    large &&
      h(
        "span",
        { class: "tag warn", title: `Larger than a sheet of ${material.sheetName} (${material.title})` },
        `over ${material.sheetName}`,
      ),
  );
}

const fits = (w, d, [a, b]) => Math.min(w, d) <= Math.min(a, b) && Math.max(w, d) <= Math.max(a, b);

function onKey(event, model, stage) {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  const { selected } = stage.selection;
  if (!step) return;
  event.preventDefault();
  const next =
    selected === null
      ? step > 0
        ? 0
        : model.parts.length - 1
      : (selected + step + model.parts.length) % model.parts.length;
  stage.setSelection({ selected: next, seam: null });
}

const labelOf = (model, id) => model.parts[model.partIndex.get(id)]?.label ?? String(id);

function partDetail(model, stage, k) {
  const part = model.parts[k];
  const alone = stage.result?.state.only === k;
  return h(
    "div",
    { class: "detail-card" },
    h(
      "div",
      { class: "row" },
      h("h2", {}, `Part ${part.label}`),
      h(
        "button",
        {
          type: "button",
          class: "small right",
          "aria-pressed": String(alone),
          onclick: () => {
            stage.pose({ only: alone ? null : k });
            stage.setSelection({});
          },
        },
        alone ? "Show all" : "Show alone",
      ),
    ),
    part.mirrorOf !== null && h("p", { class: "hint" }, `Mirror image of ${labelOf(model, part.mirrorOf)}.`),
    h(
      "p",
      { class: "hint" },
      `${bendWords(part)}, ${count(part.seams.length, "edge")}:`,
    ),
    h(
      "ul",
      { class: "seam-list" },
      part.seams.map((id) => {
        const seam = model.seams.find((item) => item.id === id);
        const other = seam.parts[0] === part.id ? seam.parts[1] : seam.parts[0];
        const text = seam.border ? "free edge" : seam.self ? "to itself" : `to ${labelOf(model, other)}`;
        return h(
          "li",
          {},
          h(
            "button",
            { type: "button", class: "link", onclick: () => stage.choose({ part: null, seam: id }) },
            h("span", { class: "tag" }, seam.name),
            ` ${text}`,
            h("span", { class: "hint right" }, millimetres(seam.length)),
          ),
        );
      }),
    ),
  );
}

const bendWords = ({ rulings }) =>
  rulings.length === 0 ? "Stays flat" : `${count(rulings.length / 2, "bend line")} (one for every ${BEND_STEP}° of bend)`;

function seamDetail(model, stage, id) {
  const seam = model.seams.find((item) => item.id === id);
  const join = seam.border
    ? h("p", {}, `Free edge of ${labelOf(model, seam.parts[0])}.`)
    : seam.self
      ? h("p", {}, `${labelOf(model, seam.parts[0])} is joined to itself here.`)
      : h(
          "p",
          {},
          "Joins ",
          partLink(model, stage, seam.parts[0]),
          " and ",
          partLink(model, stage, seam.parts[1]),
          ".",
        );
  return h(
    "div",
    { class: "detail-card" },
    h("h2", {}, `${seam.border ? "Edge" : "Seam"} ${seam.name}`),
    join,
    h("p", { class: "hint" }, `${millimetres(seam.length)} long${seam.border ? "" : " on both sides"}.`),
  );
}

function partLink(model, stage, id) {
  return h(
    "button",
    {
      type: "button",
      class: "link inline",
      onclick: () => stage.choose({ part: model.partIndex.get(id), seam: null }),
    },
    labelOf(model, id),
  );
}
