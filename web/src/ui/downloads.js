// The stored files of a result, as they were computed: for programs, and to look things up.
import { h } from "../dom.js";
import { bytes } from "../format.js";

const KNOWN = {
  "ruled.obj": "3D model: the sheets in space, with the layout as texture coordinates",
  "layout.json": "every part, seam and figure for programs",
  "layout.svg": "plain drawing of all parts, true to scale",
};

export function downloads(files) {
  return h(
    "details",
    { class: "more" },
    h("summary", {}, "Files of the computation"),
    h(
      "ul",
      { class: "plain-files" },
      Object.keys(files)
        .sort()
        .map((name) =>
          h(
            "li",
            {},
            h("a", { href: files[name].href, download: name }, name),
            h("span", { class: "hint" }, [KNOWN[name] ?? files[name].title, bytes(files[name].length ?? 0)].join(" · ")),
          ),
        ),
    ),
  );
}
