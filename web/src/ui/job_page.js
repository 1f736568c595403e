// One job: it waits or runs, has failed, or shows its result.
import { A_MOMENT, getGuides, getInput, getJob } from "../api.js";
import { announce, h, replace } from "../dom.js";
import { drafts, guessUp } from "../drafts.js";
import { count, duration, extent } from "../format.js";
import { Guides } from "../guides.js";
import { ACTIVE, STAGES, jobs, secondsLeft, titleOf } from "../jobs.js";
import { rememberOf } from "../prefs.js";
import { finishedOf, isSweep, stepOf } from "../result/trade_off.js";
import { asAsked, scaleOf, viewOf } from "../variants.js";
import { placesOf } from "../result/places.js";
import { inspectFile } from "../worker/client.js";
import { fileHead } from "./file_head.js";
import { icon } from "./icons.js";
import { inPageWords, marked, problemBox } from "./problem.js";
import { removeButton } from "./remove_button.js";
import { ResultView } from "./result_view.js";
import { sweepView } from "./sweep_view.js";
import { stopButton, wordsOfStop } from "./trade_off_chart.js";

export function jobPage({ go, stage, process, id }) {
  const panel = h("section", { class: "panel", "aria-label": "Job" });
  const heading = h("h1", { class: "visually-hidden" }, "Job");
  const element = h("main", { class: "work", id: "main", tabindex: "-1" }, heading, stage.element, panel);
  const page = new JobPage({ go, stage, process, id, panel, element, heading });
  page.start();
  return page;
}

class JobPage {
  title = "";

  constructor(context) {
    Object.assign(this, context);
    this.shown = ""; // the state on show
  }

  async start() {
    this.stage.clear("");
    jobs.open = this.id;
    this.stop = jobs.onChange(() => this.update());
    if (!jobs.get(this.id)) {
      replace(this.panel, h("p", { class: "busy" }, "Asking the server …"));
      return this.ask();
    }
    this.update();
  }

  async ask() {
    try {
      jobs.put(await getJob(this.id));
      this.update();
    } catch (error) {
      if (this.gone || jobs.get(this.id)) return;
      this.lost(error);
      if (error.passing) setTimeout(() => !this.gone && this.ask(), A_MOMENT);
    }
  }

  lost(error) {
    if (this.shown === "lost" && error.passing) return; // it has been said
    this.shown = "lost";
    this.element.classList.add("alone");
    const gone = error.problem?.status === 404 && {
      title: "There is no such job",
      detail: "It was removed, or the link is not complete.",
      fix: "Old jobs are removed after a while; drop the mesh again to make a new one",
    };
    replace(this.panel, problemBox(gone || error, h("a", { class: "button primary", href: "#" }, "All jobs")));
  }

  dispose() {
    for (const stop of [this.stop, ...(this.stops ?? [])]) stop?.();
    this.result?.dispose();
    clearInterval(this.clock);
    if (jobs.open === this.id) jobs.open = null;
    this.gone = true;
  }

  update() {
    const job = jobs.get(this.id);
    if (!job) {
      if (this.shown && this.shown !== "lost") this.go("#");
      return;
    }
    this.title = this.heading.textContent = titleOf(job);
    document.title = ACTIVE.has(job.status)
      ? `${job.progress} % · ${this.title} · sheetform`
      : `${this.title} · sheetform`;
    const kind = ACTIVE.has(job.status) ? "active" : job.status;
    if (kind === "active") this.showProgress(job);
    if (kind === this.shown) return;
    const before = this.shown;
    this.element.classList.remove("alone");
    this.shown = kind;
    clearInterval(this.clock);
    if (kind === "active") {
      this.clock = setInterval(() => this.showProgress(jobs.get(this.id)), 1000);
      this.showInput(job);
    }
    if (kind === "failed" || kind === "dismissed") {
      this.showEnded(job);
      if (before !== "active" || job.exception) this.showInput(job); // again, with what is wrong marked
    }
    if (kind === "successful") {
      if (isSweep(job)) this.showSweep(job);
      else this.showResult(job);
    }
    if (before === "active")
      announce(
        { successful: "The sheets are ready.", failed: "The job has failed.", dismissed: "The job was cancelled." }[
          kind
        ] ?? "",
      );
  }

  up(mesh) {
    return viewOf(jobs.get(this.id) ?? { jobID: this.id }).up ?? guessUp(mesh);
  }

  rememberUp(up) {
    rememberOf(this.id, { up });
  }

  /** The uploaded mesh, read once; null when it cannot be had. */
  mesh() {
    return (this.meshPromise ??= this.fetchMesh());
  }

  async fetchMesh() {
    try {
      return await inspectFile(await getInput(this.id));
    } catch (error) {
      if (!error.passing || this.gone) return null;
      await new Promise((later) => setTimeout(later, A_MOMENT));
      return this.fetchMesh();
    }
  }

  async showInput(job) {
    if (!this.stage.input) this.stage.clear("Fetching the mesh …");
    const mesh = await this.mesh();
    const guides = mesh && (await getGuides(job).catch(() => null));
    if (this.gone || this.result) return;
    if (!mesh) return this.stage.clear("The mesh cannot be shown.");
    const places = placesOf(job.exception, mesh);
    this.stage.showInput(mesh, {
      up: this.up(mesh),
      scale: scaleOf(job),
      onUp: (up) => this.rememberUp(up),
      places,
      guides: new Guides(guides),
    });
    if (places.length > 0) this.showEnded(job, places);
  }

  showProgress(job) {
    if (!job || !ACTIVE.has(job.status)) return;
    const waiting = job.status === "accepted";
    const done = STAGES.findIndex(([stage]) => stage === job.stage);
    const left = secondsLeft(job);
    const elapsed = job.started ? (Date.now() - new Date(job.started).getTime()) / 1000 : 0;
    this.progress ??= this.makeProgress();
    const { bar, percentText, times, stages, heading } = this.progress;
    heading.textContent = waiting
      ? job.queuePosition > 1
        ? `Waits: number ${job.queuePosition} in the queue`
        : "Waits: next in line"
      : isSweep(job)
        ? `Comparing tolerances ${stepOf(job)}`
        : "Making the sheets";
    bar.value = waiting ? 0 : job.progress;
    percentText.textContent = waiting ? "" : `${job.progress} %`;
    times.textContent = waiting
      ? ""
      : [`${duration(elapsed)} so far`, left !== null && `about ${duration(Math.max(1, left))} left`]
          .filter(Boolean)
          .join(" · ");
    stages.forEach((item, k) => {
      item.className = waiting || k > done ? "later" : k < done ? "done" : "now";
      item.toggleAttribute("aria-current", !waiting && k === done);
    });
    this.progress.keep.hidden = waiting || finishedOf(job) === 0;
    this.progress.keep.textContent = wordsOfStop(job);
    if (!this.progress.element.isConnected) replace(this.panel, this.progress.element);
  }

  makeProgress() {
    const bar = h("progress", { max: "100", "aria-label": "Progress" });
    const percentText = h("strong", { class: "percent" });
    const times = h("p", { class: "hint times" });
    const heading = h("h3", {});
    const note = h("div", {});
    const keep = stopButton(jobs.get(this.id), note, "");
    const stages = STAGES.map(([, text]) => h("li", {}, h("span", { class: "bullet", "aria-hidden": "true" }), text));
    const cancel = h(
      "button",
      {
        type: "button",
        class: "small",
        onclick: async () => {
          cancel.disabled = true;
          try {
            await jobs.dismiss(this.id);
          } catch (error) {
            replace(note, problemBox(error));
          }
          cancel.disabled = false;
        },
      },
      "Cancel",
    );
    const element = h(
      "div",
      { class: "progress-panel" },
      headOf(jobs.get(this.id)),
      heading,
      h("div", { class: "percent-row" }, percentText, times),
      h("div", { class: "row bar-row" }, bar, cancel),
      keep,
      h("ol", { class: "stages" }, stages),
      note,
    );
    return { element, bar, percentText, times, stages, heading, keep };
  }

  showEnded(job, places = []) {
    // A mesh that was refused will be refused again; one that took too long may do with other settings.
    const { status, type = "", where = "" } = job.exception ?? {};
    const setting = this.process.inputs[where.split(",")[0]] !== undefined; // it is not the mesh that is at fault
    const refused = status === 422 && !setting && !/(time|memory)-limit$/.test(type);
    const another = h("a", { class: "button primary", href: "#" }, "Choose another mesh");
    const again = h(
      "button",
      { type: "button", class: refused ? null : "primary", onclick: () => this.runAgain(job) },
      icon("again", 18),
      "Change settings",
    );
    const retry = h("button", { type: "button", onclick: () => this.act(() => jobs.retry(this.id)) }, "Try again");
    const remove = removeButton("Remove", () => this.act(() => jobs.dismiss(this.id)), "");
    const ways = refused ? [another, again, remove] : [again, !setting && retry, remove];
    const problem = job.exception
      ? inPageWords(job.exception, this.process.inputs)
      : { title: "The job failed", detail: job.message };
    this.note = h("div", {});
    replace(
      this.panel,
      headOf(job),
      job.status === "failed"
        ? problemBox(marked(problem, places), ...ways)
        : h(
            "section",
            { class: "ended" },
            h("h3", {}, "Cancelled"),
            h("p", {}, "The job was stopped before it was done."),
            h("div", { class: "row" }, ways),
          ),
      this.note,
    );
  }

  async act(action) {
    try {
      await action();
    } catch (error) {
      replace(this.note, problemBox(error));
    }
  }

  /** A new draft of the same mesh with the same parameters. */
  async runAgain(job, change = {}) {
    try {
      const name = job.inputs?.mesh?.name || "mesh.obj";
      const [mesh, guides] = await Promise.all([getInput(this.id), getGuides(job)]);
      const file = new File([mesh], name);
      const { e_max, scale, up, material, ...values } = { ...asAsked(job), ...change };
      // Of a sweep, which has many tolerances, none is taken over.
      drafts.open([file], { tag: job.tag, scale, guides, values: isSweep(job) ? values : { ...values, e_max } });
      if (up) drafts.draft.up = up;
      if (material) drafts.draft.material = material;
      this.go("#new");
    } catch (error) {
      replace(this.note ?? this.panel, problemBox(error));
    }
  }

  showSweep(job) {
    const remove = () => jobs.dismiss(this.id).then(() => this.go("#"));
    replace(this.panel, sweepView(job, (this.stops = []), { runAgain: () => this.runAgain(job), remove }));
    this.showInput(job);
  }

  showResult(job) {
    this.result?.dispose();
    this.result = new ResultView({
      job,
      stage: this.stage,
      process: this.process,
      panel: this.panel,
      work: this.element,
      mesh: () => this.mesh(),
      up: (mesh) => this.up(mesh),
      onUp: (up) => this.rememberUp(up),
      material: viewOf(job).material,
      go: this.go,
      runAgain: (change) => this.runAgain(job, change),
      remove: () => jobs.dismiss(this.id).then(() => this.go("#")),
    });
    this.result.open();
  }
}

/** What the job is called, and what the server understood of the mesh. */
function headOf(job) {
  const mesh = job.inputs?.mesh ?? {};
  const facts = [
    job.tag && mesh.name,
    mesh.faces && count(mesh.faces, "triangle"),
    mesh.sizeMm && extent(...mesh.sizeMm),
  ].filter(Boolean);
  return fileHead(titleOf(job), facts);
}
