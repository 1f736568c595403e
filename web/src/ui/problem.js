// Errors as words: what is wrong, where, and what to do.
import { h } from "../dom.js";
import { STAGES } from "../jobs.js";
import { MeshError } from "../mesh/read_mesh.js";
import { icon } from "./icons.js";

const STAGE = new Map(STAGES);

/** Any error as {title, detail, where, fix}. */
export function wordsOf(error) {
  const problem = error.problem ?? error;
  if (problem.title) return problem;
  const title = error instanceof MeshError ? "This file cannot be used" : "Something went wrong on this page";
  return { title, detail: error.message || String(error), where: error.where, fix: error.fix };
}

/**
 * A problem of the server in the page's words: parameters and stages are called what the page calls them.
 * @param inputs of the process: {name: {title}}
 */
export function inPageWords(error, inputs) {
  const { detail, where, fix, ...more } = wordsOf(error);
  const titled = (name) => (inputs[name] ? `“${inputs[name].title}”` : name);
  const words = (text) =>
    text
      ?.replace(/ \((\w+)\)/g, (all, name) => (inputs[name] ? "" : all))
      .replace(/\b[a-z]+(?:_[a-z]+)+\b/g, titled)
      .replace(/\bin stage (\w+)/g, (all, stage) => (STAGE.has(stage) ? `at the stage “${STAGE.get(stage)}”` : all));
  const place = STAGE.has(where) ? "" : words(where?.replace(/^\w+(?=,|$)/, titled));
  return { ...more, detail: words(detail), where: place, fix: words(fix) };
}

/** The same, told that `places` of it are marked in the 3D view. */
export const marked = (error, places = []) => ({ ...wordsOf(error), places });

export function problemBox(error, ...actions) {
  const { title, detail, where, fix, errors = [], places = [] } = wordsOf(error);
  const sentence = (text) => text && `${text[0].toUpperCase()}${text.slice(1)}${/[.!?]$/.test(text) ? "" : "."}`;
  return h(
    "section",
    { class: "problem", role: "alert" },
    h("div", { class: "problem-head" }, icon("warn"), h("h2", {}, title)),
    detail && detail !== title && h("p", {}, sentence(detail)),
    (where || places.length > 0) &&
      h(
        "p",
        { class: "where" },
        h("span", { class: "tag" }, "Where"),
        " ",
        [where, places.length > 0 && "marked in the view"].filter(Boolean).join(" · "),
      ),
    errors.map((item) =>
      h("p", { class: "where" }, item.pointer && h("span", { class: "tag" }, item.pointer), " ", item.detail),
    ),
    fix && h("p", {}, h("span", { class: "tag good" }, "What to do"), " ", sentence(fix)),
    actions.length > 0 && h("div", { class: "row" }, actions),
  );
}
