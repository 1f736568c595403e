// What a download shall be: the parameters that the server offers, sorted into fields, and what was chosen as a query.

/** Offered first; all others are folded away. */
const FIRST = ["profile", "sheet_size", "oversize", "page", "rulings", "ruling_step", "kerf", "tabs"];

/** Chosen elsewhere on the page: a sheet in the preview, a part in the list of parts, what is up in the 3D view. */
const ELSEWHERE = new Set(["sheet", "part", "up"]);

const TITLES = {
  profile: "Machine",
  sheet_size: "Sheet",
  page: "Pages of the PDF",
  rulings: "Bend lines",
  ruling_step: "Bend per line",
  tabs: "Glue tabs",
  dxf: "DXF version",
  oversize: "If a part is larger",
  bar: "100 mm bar",
  model_size: "Size of the model",
};

const GROUPS = { sheet: "Sheets", marks: "Marks", joints: "Joints and material", file: "Files" };

/** What belongs to one model and is not remembered for the next. */
const OF_MODEL = ["sheet_size", "page", "model_size", "copies"];

/** What of the chosen values is remembered for the next model of the same material. */
export const toRemember = (values) =>
  Object.fromEntries(Object.entries(values).filter(([name]) => !OF_MODEL.includes(name)));

/** The values to begin with: what is usual, but for what was chosen the last time. */
export const firstValues = (usual, remembered) => ({ ...usual, ...toRemember(remembered) });

/** A short title: the known ones, or the name as words. */
export function titleOf(name) {
  const words = name.replaceAll("_", " ");
  return TITLES[name] ?? words[0].toUpperCase() + words.slice(1);
}

/** What the server's words stand for. */
const WORDS = {
  profile: {
    makerspace: "Laser: red cuts, blue scores",
    lightburn: "Laser with LightBurn",
    boxes: "Laser, colours of boxes.py",
    ponoko: "Ponoko (online shop)",
    silhouette: "Cutting plotter (Silhouette)",
    inventor: "Sheet metal (Inventor layers)",
    astm: "Fabric cutter (ASTM)",
    origami: "Origami Simulator",
    print: "Printer and scissors",
  },
  oversize: { refuse: "say so", split: "split it" },
  tabs: { one: "on one side", alternate: "in turns", both: "on both sides" },
  rulings: { score: "scored", perforation: "perforated", ticks: "ticks at the ends" },
};

/** A value as people write it: A4, 600 × 400 mm, LightBurn's own names as they are. */
export function wordOf(name, value) {
  if (name === "sheet_size" && value === "auto") return "as large as needed";
  if (name === "page" && value === "sheet") return "one a sheet";
  const word = WORDS[name]?.[value];
  if (word) return word;
  if (/^a\d$/.test(value)) return value.toUpperCase();
  return value.replace(/^(\d+)x(\d+)$/, "$1 × $2 mm") || "none";
}

/** The unit of a parameter as people write it; empty when it has none. */
export const unitOf = ({ unit = "" }) => ({ degrees: "°" })[unit] ?? unit;

/** A parameter's text without the choices or the unit at its end: the field shows them. */
export function hintOf({ text, unit, choices = [] }) {
  const tail = [`: ${choices.join(", ")}`, ": on or off", ` (${unit})`].find((end) => text.endsWith(end)) ?? "";
  return text.slice(0, text.length - tail.length);
}

/** The parameter that a problem is about: "sheet" is what the size of the sheet is called in answers. */
export const culpritOf = (where) => (where === "sheet" ? "sheet_size" : where);

/** The kind of field: "switch", "choice", "open-choice", "number" or "text". */
export function kindOf({ type, choices, open }) {
  if (type === "switch") return type;
  if (choices) return open ? "open-choice" : "choice";
  return type === "number" || type === "integer" ? "number" : "text";
}

/** {first: [parameter], groups: [[title, [parameter]]]}: every parameter once, in the server's groups. */
export function sortedFields(parameters) {
  const shown = parameters.filter(({ name }) => !ELSEWHERE.has(name));
  const first = FIRST.map((name) => shown.find((one) => one.name === name)).filter(Boolean);
  const groups = new Map();
  for (const one of shown) {
    if (first.includes(one)) continue;
    const title = GROUPS[one.group] ?? "Other";
    groups.set(title, [...(groups.get(title) ?? []), one]);
  }
  return { first, groups: [...groups] };
}

/** What differs from the defaults, as a query: that alone is asked for. */
export function queryOfWish(parameters, values, more = {}) {
  const query = new URLSearchParams();
  for (const { name, default: otherwise } of parameters) {
    const value = (values[name] ?? "").trim();
    if (!ELSEWHERE.has(name) && value !== "" && value !== otherwise) query.set(name, value);
  }
  for (const [name, value] of Object.entries(more)) query.set(name, value);
  return query;
}

export const hrefOf = (href, query) => (String(query) ? `${href}?${query}` : href);

const MARGIN = 5; // of a machine
const PRINTER = 10; // white edge of a printer
const TAB = 6;

/**
 * What is usual: the material's sheet when every part fits on it, otherwise one as large as the parts need. Paper is
 * printed at home: a page a sheet, inside of what the printer leaves white, or one large sheet over several pages; and
 * it is glued, so it has tabs. Stiff sheets bend round by themselves: a line would only weaken them, ticks say which way.
 */
export function usualWish(material, parts) {
  const paper = material.id === "paper";
  const edge = paper ? PRINTER + TAB : MARGIN;
  const [a, b] = material.sheet.map((side) => side - 2 * edge);
  const fits = parts.every(({ box: [x0, y0, x1, y1] }) => {
    const [w, d] = [x1 - x0, y1 - y0];
    return Math.min(w, d) <= Math.min(a, b) && Math.max(w, d) <= Math.max(a, b);
  });
  const wish = { sheet_size: fits ? material.preset : "auto", page: "sheet" };
  if (material.stiff) return { ...wish, rulings: "ticks" };
  wish.ruling_step = "10"; // half as many lines as usual are enough for what bends easily
  if (!paper) return wish;
  return { ...wish, ...(fits ? { margin: String(PRINTER) } : { page: material.preset }), profile: "print", tabs: "one" };
}
