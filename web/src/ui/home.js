// The first thing one sees: where to drop a mesh, shapes to try, and one's jobs.
import { h } from "../dom.js";
import { ACCEPTED, drafts } from "../drafts.js";
import { jobs } from "../jobs.js";
import { SAMPLES, sampleFile } from "../mesh/samples.js";
import { recall, remember } from "../prefs.js";
import { icon } from "./icons.js";
import { illustration } from "./illustration.js";
import { JobCards } from "./job_cards.js";

const A_MOMENT = 1000; // milliseconds

/** A file chooser that opens drafts; the returned input must be in the page. */
function chooser(go) {
  return h("input", {
    type: "file",
    accept: ACCEPTED,
    multiple: true,
    class: "visually-hidden",
    id: "file",
    tabindex: "-1",
    "aria-hidden": "true",
    onchange: (event) => {
      if (event.target.files.length > 0) {
        drafts.open(event.target.files);
        go("#new");
      }
    },
  });
}

export function homePage({ go }) {
  const input = chooser(go);
  const drop = h(
    "div",
    { class: "drop" },
    illustration(),
    h(
      "div",
      { class: "drop-text" },
      h("h1", {}, "From a mesh to sheets you can cut"),
      h(
        "p",
        { class: "lead" },
        "Drop a 3D model. It comes back as flat parts that bend into its shape without stretching: paper, card, plywood or metal.",
      ),
      h(
        "div",
        { class: "row center" },
        h(
          "button",
          { class: "primary large", type: "button", onclick: () => input.click() },
          icon("upload"),
          "Choose a mesh",
        ),
        input,
      ),
      h("p", { class: "hint" }, "or drop it anywhere on this page. STL, OBJ, PLY or OFF, several at once if you like."),
    ),
  );
  const samples = h(
    "section",
    { class: "samples", "aria-labelledby": "samples-title" },
    h("h2", { id: "samples-title" }, "No file at hand? Try a shape"),
    h(
      "div",
      { class: "chips" },
      SAMPLES.map((sample) =>
        h(
          "button",
          { type: "button", class: "chip", title: sample.text, onclick: () => openSample(sample, go) },
          sample.title,
        ),
      ),
    ),
  );
  const cards = new JobCards();
  const section = h("section", { class: "jobs" }, h("h2", {}, "Your jobs"), cards.element);
  const update = () => {
    section.hidden = jobs.list.size === 0;
    if (jobs.known) remember("had-jobs", !section.hidden);
    cards.show();
  };
  const element = h("main", { class: "home", id: "main", tabindex: "-1" }, drop, samples, section);
  const stops = [layOut(element), jobs.onChange(update)];
  update();
  const clock = setInterval(update, 30000); // "2 minutes ago" grows old
  return {
    title: "",
    element,
    dispose() {
      for (const stop of stops) stop();
      clearInterval(clock);
      cards.dispose();
    },
  };
}

/**
 * Who has jobs sees them without scrolling: the rest is made compact. Who is here for the first time waits for the list, a
 * moment at most; what comes later still counts as long as nobody has begun to do something: nothing moves under the
 * pointer. Returns what ends it.
 */
function layOut(element) {
  const had = jobs.known ? jobs.list.size > 0 : recall("had-jobs");
  const ended = new AbortController();
  const stop = () => ended.abort();
  const show = (compact) => {
    element.classList.toggle("compact", compact);
    element.classList.remove("unsettled");
  };
  if (had !== null) {
    show(had);
    return stop;
  }
  element.classList.add("unsettled");
  const timer = setTimeout(() => show(false), A_MOMENT);
  const forget = jobs.onChange(() => {
    if (!jobs.known) return;
    show(jobs.list.size > 0);
    stop();
  });
  ended.signal.addEventListener("abort", () => {
    clearTimeout(timer);
    forget();
  });
  const begun = () => element.classList.contains("unsettled") || stop();
  for (const kind of ["pointermove", "pointerdown", "keydown", "wheel"])
    addEventListener(kind, begun, { signal: ended.signal, passive: true });
  return stop;
}

function openSample(sample, go) {
  drafts.open([sampleFile(sample)]);
  drafts.draft.up = "z";
  drafts.draft.tag = sample.title;
  go("#new");
}
