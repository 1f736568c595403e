// The jobs as cards. A card stays the same element as long as its job is there: only what has changed in it is written.
import { h, replace } from "../dom.js";
import { ago, count, millimetres, percent } from "../format.js";
import { ACTIVE, jobs, titleOf } from "../jobs.js";
import { hasPicture, pictureOf } from "../prefs.js";
import { isSweep } from "../result/trade_off.js";
import { scaleOf } from "../variants.js";
import { cutPicture } from "./cut_picture.js";
import { icon } from "./icons.js";
import { problemBox } from "./problem.js";

const PAGE = 60; // cards; more when asked for

export class JobCards {
  cards = new Map(); // by job
  shown = PAGE;

  constructor() {
    this.list = h("div", { class: "cards" });
    this.more = h("button", { type: "button", onclick: () => this.showMore() }, "Older jobs");
    this.note = h("div", {});
    this.foot = h("div", { class: "row center" }, this.more);
    this.element = h("div", { class: "job-cards" }, this.list, this.note, this.foot);
  }

  /** What is running, then the newest; cards are put in order without moving those that stay. */
  show() {
    const all = jobs.newestFirst();
    const running = all.filter(({ status }) => status === "running");
    const wanted = [...running, ...all.filter(({ status }, k) => k < this.shown && status !== "running")];
    const focused = document.activeElement;
    const ids = new Set(wanted.map(({ jobID }) => jobID));
    for (const id of this.cards.keys()) if (!ids.has(id)) this.remove(id);
    let place = this.list.firstChild;
    for (const job of wanted) {
      const card = this.cards.get(job.jobID) ?? this.add(job);
      card.show(job);
      const { element } = card;
      // One that stands too early is taken out, and put in when it is its turn.
      if (place && element === place.nextSibling) {
        place.remove();
        place = element;
      }
      if (element === place) place = place.nextSibling;
      else this.list.insertBefore(element, place);
    }
    if (focused !== document.activeElement && this.list.contains(focused)) focused.focus({ preventScroll: true });
    // A list that came whole ends; of a longer one the server has the rest.
    this.foot.hidden = all.length <= this.shown && !(jobs.older && all.length >= 100);
  }

  add(job) {
    const card = new Card(job.jobID);
    this.cards.set(job.jobID, card);
    return card;
  }

  remove(id) {
    this.cards.get(id).dispose();
    this.cards.delete(id);
  }

  async showMore() {
    const last = this.list.lastElementChild;
    this.shown += PAGE;
    this.more.disabled = true;
    try {
      if (jobs.list.size < this.shown) await jobs.more();
      replace(this.note);
    } catch (error) {
      replace(this.note, problemBox(error));
    }
    this.more.disabled = false;
    this.show();
    last?.nextElementSibling?.focus(); // by keys one goes on where one was
  }

  dispose() {
    for (const id of [...this.cards.keys()]) this.remove(id);
  }
}

class Card {
  constructor(id) {
    this.id = id;
    this.thumb = h("div", { class: "thumb" });
    this.title = h("strong", {});
    this.words = h("span", { class: "hint" });
    this.text = h("div", { class: "card-text" }, this.title, this.words);
    this.element = h("a", { href: `#job/${id}` }, this.thumb, this.text);
  }

  show(job) {
    this.write(this.element, "className", `card ${job.status}`);
    this.write(this.title, "textContent", titleOf(job));
    this.write(this.title, "title", titleOf(job)); // a long one is cut off
    this.write(this.words, "textContent", subtitle(job));
    this.showProgress(job);
    this.showPicture(job);
  }

  /** Writing the same again would make work for the browser, and for a screen reader. */
  write(element, property, value) {
    if (element[property] !== value) element[property] = value;
  }

  showProgress(job) {
    if (!ACTIVE.has(job.status)) {
      this.bar?.remove();
      this.bar = null;
      return;
    }
    if (!this.bar) this.text.append((this.bar = h("progress", { max: "100", "aria-label": "progress" })));
    this.write(this.bar, "value", job.progress ?? 0);
  }

  /** This device's own picture; else, of another device or a forgetful browser, the cut drawing. */
  showPicture(job) {
    const kind = hasPicture(this.id) ? "own" : isSweep(job) || job.status !== "successful" ? iconOf(job) : "drawing";
    if (kind === this.kind) return;
    this.kind = kind;
    this.forgetPicture();
    if (kind === "own") this.url = URL.createObjectURL(pictureOf(this.id));
    replace(
      this.thumb,
      this.url ? h("img", { src: this.url, alt: "" }) : kind === "drawing" ? cutPicture(this.id) : icon(kind, 34),
    );
  }

  forgetPicture() {
    if (this.url) URL.revokeObjectURL(this.url);
    this.url = null;
  }

  dispose() {
    this.element.remove();
    this.forgetPicture();
  }
}

function iconOf(job) {
  if (job.status === "failed") return "warn";
  return isSweep(job) && job.status === "successful" ? "curve" : "cube";
}

function subtitle(job) {
  const when = ago(job.created);
  if (job.status === "successful" && isSweep(job)) return `${rangeOf(job.report ?? {})} · ${when}`;
  if (job.status === "successful") {
    const { patches, hausdorff, e_max_met: met = true } = job.report ?? {};
    return [
      patches && count(patches, "part"),
      Number.isFinite(hausdorff) &&
        (met ? `within ${errorText(job, hausdorff)}` : `${errorText(job, hausdorff)} off, tolerance missed`),
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

/** A sweep in words: "6 tolerances, 4 to 31 parts"; when it ended early, "4 of 6 tolerances". */
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
