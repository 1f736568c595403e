// The files of a result, those to cut first, each with what it is for.
import { zipHref } from "../api.js";
import { h } from "../dom.js";
import { bytes } from "../format.js";
import { icon } from "./icons.js";

const KNOWN = {
  "layout.svg": ["To cut: SVG", "drawing in millimetres for laser, plotter, Inkscape"],
  "layout.dxf": ["To cut: DXF", "for CAD and CAM"],
  "layout.pdf": ["To print: PDF", "true to scale, print at 100 %"],
  "layout.fold": ["FOLD", "crease pattern for folding programs"],
  "ruled.obj": ["3D model", "the sheets in space, with the layout as texture coordinates"],
  "layout.json": ["Layout data", "every part, seam and figure for programs"],
};
const ORDER = Object.keys(KNOWN);

export function downloads(files, job) {
  const names = Object.keys(files).sort((a, b) => rank(a) - rank(b) || (a < b ? -1 : 1));
  return h(
    "section",
    { class: "downloads" },
    h(
      "a",
      { class: "button primary wide", href: zipHref(job.jobID), download: "" },
      icon("download"),
      "Everything as ZIP",
    ),
    h(
      "ul",
      { class: "files-list" },
      names.map((name) => {
        const [title, text] = KNOWN[name] ?? [files[name].title ?? name, ""];
        return h(
          "li",
          {},
          h(
            "a",
            { href: files[name].href, download: name },
            h("span", { class: "file-icon", "aria-hidden": "true" }, name.split(".").pop()),
            h(
              "span",
              {},
              h("strong", {}, title),
              h("span", { class: "hint" }, [text, name, bytes(files[name].length ?? 0)].filter(Boolean).join(" · ")),
            ),
          ),
        );
      }),
    ),
  );
}

const rank = (name) => (ORDER.includes(name) ? ORDER.indexOf(name) : ORDER.length);
