// Errors as words: what is wrong, where, and what to do.
import { h } from "../dom.js";
import { MeshError } from "../mesh/read_mesh.js";
import { icon } from "./icons.js";

/** Any error as {title, detail, where, fix}. */
export function wordsOf(error) {
  const problem = error.problem ?? error;
  if (problem.title) return problem;
  const title = error instanceof MeshError ? "This file cannot be used" : "Something went wrong on this page";
  return { title, detail: error.message || String(error), where: error.where, fix: error.fix };
}

export function problemBox(error, ...actions) {
  const { title, detail, where, fix, errors = [] } = wordsOf(error);
  const sentence = (text) => text && `${text[0].toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`;
  return h(
    "section",
    { class: "problem", role: "alert" },
    h("div", { class: "problem-head" }, icon("warn"), h("h2", {}, title)),
    detail && detail !== title && h("p", {}, sentence(detail)),
    where && h("p", { class: "where" }, h("span", { class: "tag" }, "Where"), " ", where),
    errors.map((item) =>
      h("p", { class: "where" }, item.pointer && h("span", { class: "tag" }, item.pointer), " ", item.detail),
    ),
    fix && h("p", {}, h("span", { class: "tag good" }, "What to do"), " ", sentence(fix)),
    actions.length > 0 && h("div", { class: "row" }, actions),
  );
}
