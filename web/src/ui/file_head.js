// The head of a panel: what it is about. A long name is cut off after two lines; the pointer shows all of it.
import { h } from "../dom.js";

/** @param facts texts, shown in small below the name */
export function fileHead(name, facts = []) {
  return h(
    "header",
    { class: "file-head" },
    h("h2", { title: name }, name),
    facts.length > 0 && h("p", { class: "hint", title: facts.join(" · ") }, facts.join(" · ")),
  );
}
