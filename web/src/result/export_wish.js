// What a download shall be: the parameters that the server offers, sorted into fields, and what was chosen as a query.

/** Offered first; all others are folded away. */
export const FIRST = ["profile", "sheet_size", "oversize", "page", "kerf", "rulings", "tabs"];

/** Chosen elsewhere on the page: a sheet in the preview, a part in the list of parts. */
const ELSEWHERE = new Set(["sheet", "part"]);

const TITLES = {
  profile: "Machine",
  sheet_size: "Sheet",
  page: "Pages of the PDF",
  rulings: "Bend lines",
  tabs: "Glue tabs",
  dxf: "DXF version",
  oversize: "If a part is larger",
  bar: "100 mm bar",
  up: "Axis that points up",
};

const GROUPS = [
  ["Sheets", ["model_size", "margin", "gap", "turns", "grain", "copies", "face"]],
  [
    "Marks",
    [
      ...["label_height", "seam_text_height", "smallest_text", "notches", "notch_size"],
      ...["ruling_step", "hidden_bend", "ruling_clear", "dash", "dash_gap", "tick_length", "bar"],
    ],
  ],
  ["Joints and material", ["tab_depth", "tab_angle", "tab_pitch", "thickness", "surface", "material", "hinges"]],
  ["Files", ["dxf", "page_margin", "page_overlap", "cover", "steps", "up", "frame_radius", "frame_text", "frame_borders"]],
];

/** A short title: the known ones, or the name as words. */
export function titleOf(name) {
  const words = name.replaceAll("_", " ");
  return TITLES[name] ?? words[0].toUpperCase() + words.slice(1);
}

/** A value as people write it: A4, 600 × 400 mm, LightBurn's own names as they are. */
export function wordOf(name, value) {
  if (name === "sheet_size" && value === "auto") return "as large as needed";
  if (name === "page" && value === "sheet") return "one a sheet";
  if (name === "oversize") return { refuse: "say so", split: "split it" }[value] ?? value;
  if (/^a\d$/.test(value)) return value.toUpperCase();
  return value.replace(/^(\d+)x(\d+)$/, "$1 × $2 mm") || "none";
}

/** The unit of a parameter, as the server says it or as its text begins; empty when it has none. */
export const unitOf = ({ unit, text }) =>
  ({ mm: "mm", degrees: "°" })[unit] ?? (/^mm\b/.test(text) ? "mm" : /^Degrees\b/.test(text) ? "°" : "");

/** A parameter's text without what its field says anyway: the unit in front, the choices behind. */
export function hintOf({ text, choices = [] }) {
  const tail = [`: ${choices.join(", ")}`, ": on or off"].find((end) => text.endsWith(end)) ?? "";
  const rest = text.slice(0, text.length - tail.length).replace(/^mm,? ?| \((mm|degrees)\)$/g, "");
  return rest && rest[0].toUpperCase() + rest.slice(1);
}

/** The parameter that a problem is about: "sheet" is what the size of the sheet is called in answers. */
export const culpritOf = (where) => (where === "sheet" ? "sheet_size" : where);

/** The kind of field: "switch", "choice", "open-choice", "number" or "text". */
export function kindOf({ default: otherwise, choices, open }) {
  if (choices?.length === 2 && choices.includes("on") && choices.includes("off")) return "switch";
  if (choices) return open ? "open-choice" : "choice";
  return otherwise !== "" && Number.isFinite(Number(otherwise)) ? "number" : "text";
}

/** {first: [parameter], groups: [[title, [parameter]]]}: every parameter once, unknown ones in a group of their own. */
export function sortedFields(parameters) {
  const rest = new Map(parameters.filter(({ name }) => !ELSEWHERE.has(name)).map((one) => [one.name, one]));
  const take = (names) =>
    names
      .map((name) => {
        const one = rest.get(name);
        rest.delete(name);
        return one;
      })
      .filter(Boolean);
  const first = take(FIRST);
  const groups = GROUPS.map(([title, names]) => [title, take(names)]);
  return { first, groups: [...groups, ["Other", [...rest.values()]]].filter(([, list]) => list.length > 0) };
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

/**
 * What is usual: the material's sheet when every part fits on it, otherwise one as large as the parts need; paper is
 * printed at home, over several pages.
 */
export function usualWish(material, parts, margin = 5) {
  const [a, b] = material.sheet.map((side) => side - 2 * margin);
  const fits = parts.every(({ box: [x0, y0, x1, y1] }) => {
    const [w, d] = [x1 - x0, y1 - y0];
    return Math.min(w, d) <= Math.min(a, b) && Math.max(w, d) <= Math.max(a, b);
  });
  return { sheet_size: fits ? material.preset : "auto", page: material.id === "paper" ? material.preset : "sheet" };
}
