// How far the sheets may lie from the mesh: a slider with per cent and millimetres of the finished object.
import { freshId, h } from "../dom.js";
import { diagonal } from "../drafts.js";
import { percent, significant } from "../format.js";
import { readNumber } from "./number_range.js";

const FINEST = 0.002;
const COARSEST = 0.1;

/** Works on draft.values.e_max, a fraction of the bounding-box diagonal. */
export function toleranceField(schema, draft) {
  const id = freshId("tolerance");
  const toShare = (value) => Math.log(value / FINEST) / Math.log(COARSEST / FINEST);
  const toValue = (share) => Number((FINEST * (COARSEST / FINEST) ** share).toPrecision(2));
  const limit = Math.min(schema.maximum ?? 0.5, 0.5);
  const slider = h("input", {
    type: "range",
    id,
    min: "0",
    max: "1",
    step: "0.01",
    oninput: () => set(toValue(Number(slider.value)), slider),
  });
  const asPercent = number("Tolerance in per cent of the diagonal", (value) => value / 100);
  const asMm = number("Tolerance in millimetres", (value) => value / (diagonal(draft.mesh) * draft.scale));

  function number(label, toFraction) {
    const input = h("input", {
      type: "text",
      inputmode: "decimal",
      "aria-label": label,
      oninput: () => {
        const [value, message] = readNumber(input.value, { exclusiveMinimum: 0, default: 0 });
        const fraction = message ? NaN : toFraction(value);
        const good = fraction > 0 && fraction <= limit;
        input.setAttribute("aria-invalid", String(!good));
        if (good) set(Number(fraction.toPrecision(6)), input);
      },
      onblur: () => update(),
    });
    return input;
  }
  function set(value, from) {
    draft.values.e_max = value;
    update(from);
  }
  function update(from = null) {
    const value = draft.values.e_max ?? schema.default ?? 0.02;
    draft.values.e_max = value;
    if (from !== slider) slider.value = String(Math.min(1, Math.max(0, toShare(value))));
    if (from !== asPercent) asPercent.value = significant(value * 100, 3);
    if (from !== asMm) asMm.value = significant(value * diagonal(draft.mesh) * draft.scale, 3);
    slider.setAttribute("aria-valuetext", percent(value));
  }
  update();
  return {
    update,
    element: h(
      "div",
      { class: "tolerance" },
      h(
        "label",
        { for: id, class: "hint" },
        "How far a sheet may lie from the mesh. Coarser means fewer parts and less glue.",
      ),
      slider,
      h(
        "div",
        { class: "slider-ends hint", "aria-hidden": "true" },
        h("span", {}, "true to shape"),
        h("span", {}, "few parts"),
      ),
      h(
        "div",
        { class: "pair" },
        h("label", {}, asMm, h("span", { class: "unit" }, "mm")),
        h("span", { class: "hint" }, "or"),
        h("label", {}, asPercent, h("span", { class: "unit" }, "% of diagonal")),
      ),
    ),
  };
}
