// The finished size: the unit of the file, and width, depth and height in millimetres that grow together.
import { freshId, h } from "../dom.js";
import { extents } from "../drafts.js";
import { significant } from "../format.js";
import { readNumber } from "./number_range.js";

const AXES = ["x", "y", "z"];

/** Works on draft.scale (millimetres for one unit of the file). */
export function sizeField(draft, units, onChange) {
  const name = freshId("unit");
  const sizes = extents(draft.mesh);
  const inputs = AXES.map((axis, k) => {
    const id = freshId(`size-${axis}`);
    const input = h("input", {
      type: "text",
      inputmode: "decimal",
      id,
      "aria-label": `Size along ${axis} in millimetres`,
      disabled: sizes[k] === 0,
      oninput: () => {
        const [value, message] = readNumber(input.value, { exclusiveMinimum: 0, maximum: 1e6, default: 0 });
        input.setAttribute("aria-invalid", String(Boolean(message)));
        if (message) return;
        setScale(value / sizes[k], input);
      },
      onblur: () => write(null),
    });
    return input;
  });
  const radios = units.map((unit) =>
    h("input", { type: "radio", name, value: unit.id, onchange: () => setScale(unit.scale, null) }),
  );
  const scaleText = h("span", { class: "hint" });

  function setScale(scale, from) {
    draft.scale = Number(scale.toPrecision(12));
    write(from);
    onChange();
  }
  /** Writes all fields but the one that is being typed in. */
  function write(from) {
    inputs.forEach((input, k) => {
      if (input !== from) input.value = significant(sizes[k] * draft.scale, 4);
    });
    units.forEach((unit, k) => {
      radios[k].checked = Math.abs(unit.scale - draft.scale) < 1e-9 * unit.scale;
    });
    const known = units.some((unit) => Math.abs(unit.scale - draft.scale) < 1e-9 * unit.scale);
    scaleText.textContent = known ? "" : `1 unit of the file becomes ${significant(draft.scale)} mm`;
  }
  write(null);
  /** Makes the longest side so many millimetres. */
  const setLongest = (mm) => setScale(mm / Math.max(...sizes), null);
  /** Marks the side that is the height. */
  const names = AXES.map((axis) => h("span", { "aria-hidden": "true" }, axis));
  const setUp = (up) =>
    names.forEach((name, k) => {
      const height = up.endsWith(AXES[k]);
      name.textContent = height ? `${AXES[k]} ↕` : AXES[k];
      name.parentElement.classList.toggle("height", height);
    });
  return {
    setLongest,
    setUp,
    element: h(
      "div",
      { class: "size" },
      h("div", { class: "field-head" }, h("span", { id: `${name}-label` }, "The file is in")),
      h(
        "div",
        { class: "segments", role: "radiogroup", "aria-labelledby": `${name}-label` },
        units.map((unit, k) => h("label", {}, radios[k], h("span", {}, unit.title))),
      ),
      h(
        "div",
        { class: "sizes" },
        inputs.map((input, k) =>
          h("label", { class: `axis axis-${AXES[k]}`, title: `Size along ${AXES[k]}; ↕ is the height` }, names[k], input),
        ),
        h("span", { class: "unit", "aria-hidden": "true" }, "mm"),
      ),
      scaleText,
    ),
  };
}
