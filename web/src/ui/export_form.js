// Fields for how files shall be drawn, made from the parameters that the server offers.
import { freshId, h } from "../dom.js";
import { hintOf, kindOf, sortedFields, titleOf, unitOf, wordOf } from "../result/export_wish.js";

const OWN = "=own";

export class ExportForm {
  /** @param parameters as the server lists them  @param values chosen so far, changed in place */
  constructor(parameters, values, onChange) {
    this.values = values;
    this.onChange = onChange;
    this.fields = new Map();
    const { first, groups } = sortedFields(parameters);
    this.more = h(
      "details",
      { class: "more" },
      h("summary", {}, "More about the files"),
      groups.map(([title, list]) =>
        h(
          "fieldset",
          { class: "group" },
          h("legend", {}, title),
          list.map((one) => this.field(one)),
        ),
      ),
    );
    this.element = h("div", { class: "export-form" }, first.map((one) => this.field(one)), this.more);
  }

  field(parameter) {
    const id = freshId(parameter.name);
    const kind = kindOf(parameter);
    const make = { switch: onOff, choice, "open-choice": openChoice, number: text, text };
    const set = (value) => {
      this.values[parameter.name] = value;
      this.onChange();
    };
    const control = make[kind](parameter, id, this.values[parameter.name] ?? parameter.default, set);
    this.fields.set(parameter.name, control);
    return h(
      "div",
      { class: `field ${kind}` },
      h(
        "div",
        { class: "field-head" },
        h("label", { for: id }, titleOf(parameter.name)),
        unitOf(parameter) && h("span", { class: "unit" }, unitOf(parameter)),
      ),
      control,
      h("p", { class: "hint", id: `${id}-hint` }, hintOf(parameter)),
    );
  }

  /** Marks the field that a problem is about; none when there is no problem. */
  mark(name) {
    for (const [other, control] of this.fields) {
      const input = control.matches("input, select")
        ? control
        : (control.querySelector("input:not([hidden])") ?? control.querySelector("select"));
      if (other === name) input.setAttribute("aria-invalid", "true");
      else input.removeAttribute("aria-invalid");
      if (other === name && this.more.contains(control)) this.more.open = true;
    }
  }
}

const described = (id) => `${id}-hint`;

function onOff(parameter, id, value, set) {
  return h("input", {
    type: "checkbox",
    role: "switch",
    class: "switch",
    id,
    "aria-describedby": described(id),
    checked: value === "on",
    onchange: (event) => set(event.target.checked ? "on" : "off"),
  });
}

function choice({ name, choices, default: otherwise }, id, value, set) {
  const words = choices.includes(otherwise) ? choices : [otherwise, ...choices];
  const select = h(
    "select",
    { id, "aria-describedby": described(id), onchange: () => set(select.value) },
    words.map((word) => h("option", { value: word }, wordOf(name, word))),
  );
  select.value = value;
  return select;
}

/** A list of usual values, and one's own. */
function openChoice({ name, choices, default: otherwise }, id, value, set) {
  const words = choices.includes(otherwise) ? choices : [otherwise, ...choices];
  const own = h("input", {
    type: "text",
    "aria-label": `${titleOf(name)}, own value`,
    placeholder: words.includes("a4") ? "600x300" : null,
    hidden: words.includes(value),
    value: words.includes(value) ? "" : value,
    oninput: () => set(own.value.trim()),
  });
  const select = h(
    "select",
    {
      id,
      "aria-describedby": described(id),
      onchange: () => {
        own.hidden = select.value !== OWN;
        if (own.hidden) set(select.value);
        else own.focus();
      },
    },
    words.map((word) => h("option", { value: word }, wordOf(name, word))),
    h("option", { value: OWN }, "own value …"),
  );
  select.value = words.includes(value) ? value : OWN;
  return h("div", { class: "row" }, select, own);
}

function text(parameter, id, value, set) {
  return h("input", {
    type: "text",
    inputmode: kindOf(parameter) === "number" ? "decimal" : null,
    id,
    "aria-describedby": described(id),
    value,
    placeholder: parameter.default,
    oninput: (event) => set(event.target.value.replace(",", ".")),
  });
}
