// A finished job: shape and sheets side by side, what was proven, the list of parts, the files.
import { A_MOMENT, getResults, getText } from "../api.js";
import { h, replace } from "../dom.js";
import { titleOf } from "../jobs.js";
import { materialOf } from "../materials.js";
import { keepPicture } from "../prefs.js";
import { parseResult } from "../result/parse_result.js";
import { certificate } from "./certificate.js";
import { downloads } from "./downloads.js";
import { exportPanel } from "./exports.js";
import { fileHead } from "./file_head.js";
import { figures } from "./figures.js";
import { icon } from "./icons.js";
import { partsList } from "./parts_list.js";
import { problemBox } from "./problem.js";
import { removeButton } from "./remove_button.js";
import { reproduce } from "./reproduce.js";
import { tradeOff } from "./trade_off_chart.js";
import { startVariant } from "../variants.js";
import { viewControls } from "./view_controls.js";

const TABS = [
  ["result", "Result"],
  ["parts", "Parts"],
  ["files", "Files"],
];
/** On a narrow screen one thing is shown at a time. */
const NARROW = [["shape", "Shape"], ["flat", "Flat"], ...TABS];

/** A quick draft says so, and offers the real thing. */
function draftNote(job, go) {
  const problem = h("div", {});
  const button = h(
    "button",
    {
      type: "button",
      class: "primary",
      onclick: async () => {
        button.disabled = true;
        try {
          const next = await startVariant(job, { effort: "normal" });
          go(`#job/${next.jobID}`);
        } catch (error) {
          button.disabled = false;
          replace(problem, problemBox(error));
        }
      },
    },
    "Make it properly",
  );
  return h(
    "div",
    { class: "draft-note" },
    h("p", {}, h("strong", {}, "Quick draft. "), "A full run searches longer: mostly for fewer and smoother parts."),
    button,
    problem,
  );
}

export class ResultView {
  constructor(context) {
    Object.assign(this, context);
    this.stops = [];
  }

  async open() {
    if (!this.later) replace(this.panel, h("p", { class: "busy" }, "Fetching the result …"));
    try {
      const files = await getResults(this.job.jobID);
      const [obj, layout] = await Promise.all(["ruled.obj", "layout.json"].map((name) => getText(files[name].href)));
      if (this.gone) return;
      this.files = files;
      this.model = parseResult(obj, JSON.parse(layout));
      this.show();
    } catch (error) {
      if (this.gone) return;
      if (!this.later || !error.passing)
        replace(
          this.panel,
          problemBox(error.problem ? error : { title: "The result cannot be shown", detail: error.message }),
        );
      if (error.passing) this.later = setTimeout(() => this.open(), A_MOMENT);
    }
  }

  show() {
    const { model, stage, job } = this;
    const material = materialOf(this.material);
    stage.showResult(model, {
      up: this.up({ format: job.inputs?.mesh?.format ?? "obj" }),
      mesh: null,
      onUp: (up) => {
        this.onUp(up);
        this.exports?.changed();
        this.again?.changed();
      },
    });
    const controls = viewControls({ stage, model, mesh: this.mesh, material });
    replace(stage.bottom, controls.element);
    this.stops.push(controls.dispose);
    const panes = {
      result: h(
        "div",
        { class: "tab-pane" },
        job.parameters?.effort === "draft" && draftNote(job, this.go),
        figures(model, job, material, {
          showPlaces: (points) => this.showPlaces(points),
          showColours: (by) => this.showColours(controls, by),
        }),
        h(
          "button",
          { type: "button", class: "primary wide", onclick: () => this.openTab("files") },
          icon("download"),
          "Get the files",
        ),
        tradeOff(job, model.scale, this.stops),
        certificate(model),
        h(
          "div",
          { class: "row" },
          h("button", { type: "button", onclick: () => this.runAgain() }, "Run again with …"),
          removeButton("Remove job", () => this.remove()),
        ),
      ),
      parts: h("div", { class: "tab-pane" }, partsList(model, stage, material, this.stops)),
      files: () =>
        h(
          "div",
          { class: "tab-pane" },
          (this.exports = exportPanel({ job, model, material, up: () => stage.up, stops: this.stops })).element,
          h(
            "div",
            {},
            downloads(this.files),
            (this.again = reproduce(job, this.process, { up: () => stage.up, material: this.material })).element,
          ),
        ),
    };
    this.showTabs(panes);
    this.listenToEscape();
    // The picture on the job's card, once the first frame stands.
    requestAnimationFrame(() =>
      requestAnimationFrame(() => {
        if (!this.gone && stage.viewport) keepPicture(job.jobID, stage.viewport.picture());
        document.documentElement.dataset.ready = job.jobID;
      }),
    );
  }

  /** On a narrow screen the view has to come first. */
  showPlaces(points) {
    this.stage.markPlaces(points);
    if (points.length > 0 && this.narrow.matches) this.openTab("shape");
  }

  showColours(controls, by) {
    controls.show(by);
    if (this.narrow.matches) this.openTab("shape");
  }

  /** Escape lets go of what is chosen, wherever the focus is. */
  listenToEscape() {
    const onKey = (event) => event.key === "Escape" && this.stage.setSelection({ selected: null, seam: null });
    addEventListener("keydown", onKey);
    this.stops.push(() => removeEventListener("keydown", onKey));
  }

  showTabs(panes) {
    const body = h("div", { class: "tab-body", role: "tabpanel", id: "tab-body", tabindex: "0" });
    const select = (id) => {
      this.work.dataset.tab = id;
      // Made when first looked at: drawing the files costs the server something.
      if (typeof panes[id] === "function") panes[id] = panes[id]();
      if (panes[id]) replace(body, panes[id]);
      for (const button of buttons) {
        const on = button.dataset.tab === id;
        button.setAttribute("aria-selected", String(on));
        button.tabIndex = on ? 0 : -1;
      }
    };
    const makeTab = ([id, title]) =>
      h(
        "button",
        {
          type: "button",
          role: "tab",
          "data-tab": id,
          class: `tab tab-${id}`,
          "aria-controls": "tab-body",
          onclick: () => select(id),
        },
        title,
      );
    const buttons = NARROW.map(makeTab);
    this.openTab = (id) => {
      select(id);
      buttons.find((button) => button.dataset.tab === id).focus();
    };
    const bar = h(
      "div",
      {
        class: "tabs",
        role: "tablist",
        "aria-label": "Result",
        onkeydown: (event) => {
          const shown = buttons.filter((button) => button.offsetParent !== null);
          const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
          if (!step) return;
          event.preventDefault();
          const next = shown[(shown.indexOf(document.activeElement) + step + shown.length) % shown.length];
          next.click();
          next.focus();
        },
      },
      buttons,
    );
    replace(this.panel, fileHead(titleOf(this.job)), bar, body);
    const narrow = (this.narrow = matchMedia("(max-width: 760px)"));
    const adapt = () => select(narrow.matches ? "shape" : "result");
    narrow.addEventListener("change", adapt);
    this.stops.push(() => narrow.removeEventListener("change", adapt));
    adapt();
  }

  dispose() {
    this.gone = true;
    clearTimeout(this.later);
    for (const stop of this.stops) stop();
  }
}
