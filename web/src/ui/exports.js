// Files for one's own machine: chosen after the computation, drawn from the stored result, shown before they are taken.
import { A_MOMENT, getExports, getJson, getText } from "../api.js";
import { h, replace } from "../dom.js";
import { count, duration, metres, percent } from "../format.js";
import { BEDS } from "../materials.js";
import { recall, remember } from "../prefs.js";
import { culpritOf, firstValues, hrefOf, queryOfWish, toRemember, usualWish } from "../result/export_wish.js";
import { ExportForm } from "./export_form.js";
import { icon } from "./icons.js";
import { problemBox, wordsOf } from "./problem.js";

const PAUSE = 350; // milliseconds without a change before the sheets are drawn again
const QUICK = ["svg", "dxf", "pdf", "zip"];
const ENDING = { "parts-svg": "svg", "parts-dxf": "dxf", frame: "stl", "parts-json": "json", "parts-csv": "csv" };

/** @param up() the axis that points up in the 3D view: in pictures of the files, too */
export function exportPanel({ job, model, material, up, stops }) {
  const panel = new ExportPanel({ job, model, material, up });
  stops.push(() => panel.dispose());
  panel.start();
  return panel;
}

class ExportPanel {
  constructor(context) {
    Object.assign(this, context);
    this.element = h("section", { class: "exports" }, h("p", { class: "busy" }, "Asking what can be made …"));
    this.sheet = 1;
  }

  dispose() {
    this.turn = null;
    clearTimeout(this.timer);
    URL.revokeObjectURL(this.url);
  }

  async start() {
    try {
      const { formats, parameters } = await getExports(this.job.jobID);
      this.formats = formats;
      this.parameters = parameters.map((one) =>
        one.name === "sheet_size" ? { ...one, choices: [...(one.choices ?? []), ...BEDS], open: true } : one,
      );
    } catch (error) {
      if (!this.timer || !error.passing) replace(this.element, problemBox(error));
      if (error.passing) this.timer = setTimeout(() => this.start(), A_MOMENT);
      return;
    }
    this.memory = `exports-${this.material.id}`; // paper goes another way than plywood
    this.values = firstValues(usualWish(this.material, this.model.parts), recall(this.memory, {}));
    this.form = new ExportForm(this.parameters, this.values, () => this.changed());
    this.preview = h("div", { class: "sheet-preview" });
    this.summary = h("div", { class: "summary", role: "status" });
    this.archive = h("div", {});
    this.links = h("ul", { class: "files-list" });
    replace(this.element, this.preview, this.summary, this.archive, this.form.element, this.links);
    this.draw();
  }

  changed() {
    if (!this.form) return; // the server has not yet said what can be made
    remember(this.memory, toRemember(this.values));
    this.sheet = 1;
    clearTimeout(this.timer);
    this.turn = null;
    this.preview.classList.add("stale");
    this.showLinks(false); // until it is known that they can be made
    this.timer = setTimeout(() => this.draw(), PAUSE);
  }

  href(format, more = {}) {
    const { href } = this.formats.find((one) => one.format === format);
    return hrefOf(href, queryOfWish(this.parameters, this.values, { up: this.up() ?? "z", ...more }));
  }

  /** Asks for the list of parts first: it says how many sheets there are, or what is wrong with the choice. */
  async draw() {
    const turn = (this.turn = Symbol("draw"));
    try {
      const { totals, warnings } = await getJson(this.href("parts-json"));
      if (this.turn !== turn) return;
      this.form.mark("");
      this.totals = totals;
      replace(this.summary, summaryOf(totals, this.values.profile !== "print"), notes(warnings));
      this.showLinks(true);
      await this.showSheet(turn);
    } catch (error) {
      if (this.turn === turn) this.refused(error);
    }
  }

  refused(error) {
    const { where, detail, fix } = wordsOf(error);
    if (error.passing) this.timer = setTimeout(() => this.draw(), A_MOMENT);
    if (wordsOf(error).status === 429) return; // others are making files
    this.form.mark(culpritOf(where));
    replace(this.summary, h("div", { class: "warning" }, icon("warn", 18), h("div", {}, sentences(detail, fix))));
    replace(this.preview);
    this.showLinks(false);
  }

  async showSheet(turn) {
    const { sheets } = this.totals;
    const { sheet } = this;
    const drawing = await getText(this.href("svg", { sheet, inline: 1 }));
    if (this.turn !== turn || this.sheet !== sheet) return;
    URL.revokeObjectURL(this.url);
    this.url = URL.createObjectURL(new Blob([withVisibleLines(drawing)], { type: "image/svg+xml" }));
    const step = (by) => async () => {
      this.sheet += by;
      await this.showSheet(turn).catch((error) => this.refused(error));
      this.preview.querySelector(by < 0 ? ".before:not(:disabled)" : ".after:not(:disabled)")?.focus();
    };
    const turner = (by, name, glyph, label) =>
      h(
        "button",
        {
          type: "button",
          class: `small ${name}`,
          "aria-label": label,
          disabled: this.sheet + by < 1 || this.sheet + by > sheets,
          onclick: step(by),
        },
        glyph,
      );
    this.preview.classList.remove("stale");
    replace(
      this.preview,
      h(
        "a",
        { href: this.href("svg", { sheet, inline: 1 }), target: "_blank", title: "Look at it closely, in a tab of its own" },
        h("img", { src: this.url, alt: `Sheet ${this.sheet} of ${sheets}` }),
      ),
      sheets > 1 &&
        h(
          "div",
          { class: "row center" },
          turner(-1, "before", "‹", "Sheet before"),
          h("span", { class: "hint" }, `Sheet ${this.sheet} of ${sheets}`),
          turner(1, "after", "›", "Next sheet"),
        ),
    );
  }

  /** Without `good` there is nothing to take: the choice has to be mended first. */
  showLinks(good) {
    const all = this.formats.find((one) => one.format === "zip");
    const each = this.formats.filter((one) => one !== all);
    // Who prints wants pages.
    const print = this.values.profile === "print" && each.find((one) => one.format === "pdf");
    this.element.classList.toggle("nothing", !good);
    const link = (format) => (good ? { href: this.href(format), download: "" } : {});
    const first = print
      ? { format: "pdf", title: "PDF to print" }
      : all && { format: "zip", title: "Everything as ZIP" };
    const quick = this.formats.filter(({ format }) => QUICK.includes(format) && format !== first?.format);
    replace(
      this.archive,
      first && h("a", { class: "button primary wide", ...link(first.format) }, icon("download"), first.title),
      h(
        "p",
        { class: "quick" },
        h("span", { class: "hint" }, print ? "or" : "or only"),
        quick.map(({ format, title }) =>
          h(
            "a",
            { class: "button small", title, "aria-label": `${format.toUpperCase()} alone`, ...link(format) },
            format.toUpperCase(),
          ),
        ),
      ),
    );
    replace(
      this.links,
      each.map(({ format, title }) =>
        h(
          "li",
          {},
          h(
            "a",
            link(format),
            h("span", { class: "file-icon", "aria-hidden": "true" }, ENDING[format] ?? format),
            h("span", {}, h("strong", {}, title)),
          ),
        ),
      ),
    );
  }
}

/** Machines want hairlines; on the screen every line is a pixel wide. */
function withVisibleLines(svg) {
  const drawing = new DOMParser().parseFromString(svg, "image/svg+xml");
  for (const line of drawing.querySelectorAll("[stroke-width]")) {
    line.setAttribute("stroke-width", "1");
    line.setAttribute("vector-effect", "non-scaling-stroke");
  }
  return new XMLSerializer().serializeToString(drawing);
}

function sentences(...texts) {
  return texts.filter(Boolean).map((text) => h("p", {}, `${text[0].toUpperCase()}${text.slice(1)}.`));
}

/** byMachine: scissors take as long as they take. */
function summaryOf(totals, byMachine) {
  const figures = [
    count(totals.sheets, "sheet"),
    `${percent(totals.waste_share, 0)} waste`,
    `${metres(totals.cut_mm)} to cut`,
    totals.score_mm > 0 && `${metres(totals.score_mm)} to score`,
    byMachine && totals.minutes > 0 && `about ${duration(60 * totals.minutes)} on the machine`,
  ];
  return h("p", { class: "hint" }, figures.filter(Boolean).join(" · "));
}

function notes(warnings) {
  if (!warnings?.length) return null;
  return h(
    "details",
    { class: "notes" },
    h("summary", {}, count(warnings.length, "note")),
    h(
      "ul",
      {},
      warnings.map((text) => h("li", { class: "hint" }, text)),
    ),
  );
}
