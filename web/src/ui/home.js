// The first thing one sees: where to drop a mesh, shapes to try, and one's jobs.
import { h, replace } from "../dom.js";
import { ACCEPTED, drafts } from "../drafts.js";
import { ago, count, millimetres, percent } from "../format.js";
import { ACTIVE, jobs, titleOf } from "../jobs.js";
import { SAMPLES, sampleFile } from "../mesh/samples.js";
import { pictureOf } from "../prefs.js";
import { isSweep } from "../result/trade_off.js";
import { scaleOf } from "../variants.js";
import { cutPicture } from "./cut_picture.js";
import { icon } from "./icons.js";
import { illustration } from "./illustration.js";

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
  const list = h("div", { class: "cards" });
  const heading = h("h2", {}, "Your jobs");
  const section = h("section", { class: "jobs" }, heading, list);
  const urls = new Map();
  const update = () => {
    showJobs(section, list, urls);
    drop.classList.toggle("compact", !section.hidden); // the jobs shall be in sight
  };
  update();
  const stop = jobs.onChange(update);
  return {
    title: "",
    element: h("main", { class: "home", id: "main", tabindex: "-1" }, drop, samples, section),
    dispose() {
      stop();
      for (const url of urls.values()) URL.revokeObjectURL(url);
    },
  };
}

export function openSample(sample, go) {
  drafts.open([sampleFile(sample)]);
  drafts.draft.up = "z";
  drafts.draft.tag = sample.title;
  go("#new");
}

function showJobs(section, list, urls) {
  const all = jobs.newestFirst();
  section.hidden = all.length === 0;
  replace(
    list,
    all.map((job) => card(job, urls)),
  );
}

function card(job, urls) {
  return h(
    "a",
    { class: `card ${job.status}`, href: `#job/${job.jobID}` },
    h("div", { class: "thumb" }, thumbnail(job, urls)),
    h(
      "div",
      { class: "card-text" },
      h("strong", {}, titleOf(job)),
      h("span", { class: "hint" }, subtitle(job)),
      ACTIVE.has(job.status) && h("progress", { max: "100", value: job.progress, "aria-label": "progress" }),
    ),
  );
}

function thumbnail(job, urls) {
  if (!urls.has(job.jobID)) {
    const blob = pictureOf(job.jobID);
    if (blob) urls.set(job.jobID, URL.createObjectURL(blob));
  }
  const url = urls.get(job.jobID);
  if (url) return h("img", { src: url, alt: "" });
  // Another device, or a forgetful browser: the cut drawing is a picture, too.
  if (isSweep(job) && job.status === "successful") return icon("curve", 34);
  if (job.status === "successful")
    return cutPicture(job.jobID);
  return icon(job.status === "failed" ? "warn" : "cube", 34);
}

function subtitle(job) {
  const when = ago(job.created);
  if (job.status === "successful" && isSweep(job)) return `${rangeOf(job.report ?? {})} · ${when}`;
  if (job.status === "successful") {
    const { patches, hausdorff } = job.report ?? {};
    return [
      patches && count(patches, "part"),
      Number.isFinite(hausdorff) && `within ${errorText(job, hausdorff)}`,
      when,
    ]
      .filter(Boolean)
      .join(" · ");
  }
  if (job.status === "accepted")
    return job.queuePosition > 1 ? `waits, number ${job.queuePosition} in the queue` : "waits";
  if (job.status === "running") return `${job.progress} %`;
  if (job.status === "failed") return `failed · ${when}`;
  return `cancelled · ${when}`;
}

/** A sweep in words: "6 tolerances, 4 to 31 parts"; when its time ran out, "4 of 6 tolerances". */
function rangeOf({ curve = [], missing = [] }) {
  const parts = curve.map(({ patches }) => patches);
  const [least, most] = [Math.min(...parts), Math.max(...parts)];
  const done = missing.length > 0 ? `${curve.length} of ` : "";
  return `${done}${count(curve.length + missing.length, "tolerance")}, ${least < most ? `${least} to ${most}` : least} parts`;
}

function errorText(job, hausdorff) {
  const mesh = job.inputs?.mesh;
  const scale = scaleOf(job);
  return mesh ? millimetres(hausdorff * mesh.bboxDiagonal * scale) : percent(hausdorff);
}
