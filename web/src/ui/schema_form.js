// A form made from the parameters' schema: one field a parameter, with its title, text, unit, range and default.
import { freshId, h, replace } from "../dom.js";
import { significant } from "../format.js";
import { kindOf, readNumber } from "./number_range.js";

export class SchemaForm {
  /**
   * @param process as from the API  @param own names with a field of their own elsewhere on the page
   * @param values what to begin with  @param onChange called after every change
   */
  constructor(process, { own = new Set(), values = {}, onChange = () => {} }) {
    this.schemas = Object.fromEntries(
      Object.entries(process.inputs)
        .filter(([, input]) => input.schema?.["x-group"]) // the rest are files
        .map(([name, input]) => [name, { title: input.title, description: input.description, ...input.schema }]),
    );
    this.values = Object.fromEntries(Object.entries(values).filter(([name]) => this.schemas[name]));
    this.onChange = onChange;
    this.errors = new Map();
    const names = Object.keys(this.schemas)
      .filter((name) => !own.has(name))
      .sort((a, b) => (this.schemas[a]["x-order"] ?? 999) - (this.schemas[b]["x-order"] ?? 999));
    const groups = process["x-groups"] ?? [];
    const inGroup = (id) =>
      names.filter((name) => !this.schemas[name]["x-advanced"] && this.schemas[name]["x-group"] === id);
    const known = new Set(groups.map((group) => group.id));
    const rest = names.filter((name) => this.schemas[name]["x-advanced"] || !known.has(this.schemas[name]["x-group"]));
    this.element = h(
      "div",
      { class: "schema-form" },
      groups
        .filter((group) => inGroup(group.id).length > 0)
        .map((group) => this.group(group.title, group.text, inGroup(group.id))),
      rest.length > 0 && this.group("For experts", "Best left as they are.", rest),
    );
  }

  group(title, text, names) {
    return h(
      "fieldset",
      { class: "group" },
      h("legend", {}, title),
      text && h("p", { class: "hint" }, text),
      names.map((name) => this.field(name)),
    );
  }

  valueOf(name) {
    return this.values[name] ?? this.schemas[name].default;
  }

  set(name, value) {
    if (value === undefined || value === this.schemas[name].default) delete this.values[name];
    else this.values[name] = value;
    this.onChange(name);
  }

  field(name) {
    const schema = this.schemas[name];
    const id = freshId(name);
    const unit = schema["x-unit"];
    const make = {
      switch: this.switch,
      choice: this.choice,
      number: this.number,
      "number-or-off": this.numberOrOff,
      "words-or-text": this.wordsOrText,
      text: this.text,
    };
    const error = h("p", { class: "field-error", id: `${id}-error`, role: "alert", hidden: true });
    const control = make[kindOf(schema)].call(this, name, schema, id, (message) => this.report(name, error, message));
    return h(
      "div",
      { class: `field ${kindOf(schema)}` },
      h(
        "div",
        { class: "field-head" },
        h("label", { for: id }, schema.title ?? name),
        unit && h("span", { class: "unit" }, unit),
      ),
      control,
      error,
      schema.description && h("p", { class: "hint", id: `${id}-hint` }, schema.description),
    );
  }

  report(name, element, message) {
    element.hidden = !message;
    element.textContent = message ?? "";
    if (message) this.errors.set(name, message);
    else this.errors.delete(name);
    this.onChange(name);
  }

  switch(name, schema, id) {
    return h("input", {
      type: "checkbox",
      role: "switch",
      class: "switch",
      id,
      "aria-describedby": `${id}-hint`,
      checked: Boolean(this.valueOf(name)),
      onchange: (event) => this.set(name, event.target.checked),
    });
  }

  choice(name, schema, id) {
    const chosen = this.valueOf(name);
    return h(
      "div",
      { class: "segments", role: "radiogroup", id, "aria-label": schema.title ?? name },
      schema.enum.map((word) =>
        h(
          "label",
          {},
          h("input", {
            type: "radio",
            name: id,
            value: word,
            checked: word === chosen,
            onchange: () => this.set(name, word),
          }),
          h("span", {}, word),
        ),
      ),
    );
  }

  numberInput(name, schema, id, report, value) {
    const range = schema.oneOf?.find((one) => one.type === "number" || one.type === "integer") ?? schema;
    return h("input", {
      type: "text",
      inputmode: "decimal",
      id,
      "aria-describedby": `${id}-hint ${id}-error`,
      value: value === undefined ? "" : significant(value, 8),
      placeholder: schema.default === undefined ? "not set" : "",
      oninput: (event) => {
        const [number, message] = readNumber(event.target.value, range);
        event.target.setAttribute("aria-invalid", String(Boolean(message)));
        report(message);
        if (!message) this.set(name, number);
      },
    });
  }

  number(name, schema, id, report) {
    return this.numberInput(name, schema, id, report, this.valueOf(name));
  }

  numberOrOff(name, schema, id, report) {
    const value = this.valueOf(name);
    const input = this.numberInput(name, schema, id, report, value === "off" ? undefined : value);
    input.disabled = value === "off";
    const number = schema.oneOf.find((one) => one.type !== undefined && one.type !== "string");
    const fallback = typeof schema.default === "number" ? schema.default : Math.min(15, number?.maximum ?? 15);
    const toggle = h("input", {
      type: "checkbox",
      role: "switch",
      class: "switch",
      "aria-label": `${schema.title ?? name} on`,
      checked: value !== "off",
      onchange: () => {
        input.disabled = !toggle.checked;
        report(null);
        if (toggle.checked && input.value === "") input.value = String(fallback);
        this.set(name, toggle.checked ? readNumber(input.value, number ?? {})[0] : "off");
      },
    });
    return h("div", { class: "row" }, toggle, input);
  }

  wordsOrText(name, schema, id, report) {
    const words = schema.oneOf.find((one) => one.enum).enum;
    const value = this.valueOf(name);
    const own = !words.includes(value);
    const text = h("input", {
      type: "text",
      value: own ? (value ?? "") : "",
      hidden: !own,
      "aria-label": `${schema.title ?? name}, value`,
      placeholder: "0,0,1,0",
      oninput: () => {
        const good = /^\s*-?[\d.eE+-]+(\s*,\s*-?[\d.eE+-]+){3}\s*$/.test(text.value);
        report(good ? null : "Four numbers separated by commas: the normal, then the distance.");
        if (good) this.set(name, text.value.replace(/\s/g, ""));
      },
    });
    const select = h(
      "select",
      {
        id,
        "aria-describedby": `${id}-hint`,
        onchange: () => {
          text.hidden = select.value !== "=own";
          report(null);
          if (text.hidden) this.set(name, select.value);
        },
      },
      words.map((word) => h("option", { value: word }, word)),
      h("option", { value: "=own" }, "own value …"),
    );
    select.value = own ? "=own" : value;
    return h("div", { class: "row" }, select, text);
  }

  text(name, schema, id) {
    return h("input", {
      type: "text",
      id,
      "aria-describedby": `${id}-hint`,
      value: this.valueOf(name) ?? "",
      oninput: (event) => this.set(name, event.target.value || undefined),
    });
  }

  /** What differs from the defaults: that alone is sent. */
  changed() {
    return { ...this.values };
  }
}
