// The stage: the 3D window and, for results, the flat layout beside it; what is chosen in one is chosen in all.
import { h, oncePerFrame, replace } from "../dom.js";
import { UPS, extents } from "../drafts.js";
import { millimetres } from "../format.js";
import { Guides } from "../guides.js";
import { seamPlaces } from "../result/seam_places.js";
import { icon } from "../ui/icons.js";
import { drawTools } from "../ui/draw_tools.js";
import { FlatView } from "./flat_view.js";
import { GuideObject } from "./guide_object.js";
import { InputObject } from "./input_object.js";
import { Pen } from "./pen.js";
import { ResultObject } from "./result_object.js";
import { onThemeChange } from "./theme.js";
import { Viewport } from "./viewport.js";

/** The place in the middle of the list: a mean of places all around would lie inside. */
const middleOf = (places) => places[Math.floor(places.length / 2)];

/** Where the flat layout lies below the 3D view (styles/stage.css). */
const UPRIGHT = "(max-aspect-ratio: 1/1)";

export class Stage {
  constructor() {
    this.view3d = h("div", { class: "view3d" });
    this.host3d = h("div", { class: "pane pane3d" }, this.view3d);
    this.hostFlat = h("div", { class: "pane pane-flat", hidden: true });
    this.divider = h("div", {
      class: "divider",
      role: "separator",
      tabindex: "0",
      "aria-label": "Share of the 3D view",
      "aria-valuenow": "50",
      hidden: true,
    });
    this.labels = h("div", { class: "labels", "aria-hidden": "true" });
    this.tools = h("div", { class: "tools" });
    this.left = h("div", { class: "tools-left" });
    this.bottom = h("div", { class: "bottom-tools" });
    this.message = h("p", { class: "stage-message", hidden: true });
    this.element = h("div", { class: "stage" }, this.host3d, this.divider, this.hostFlat);
    this.selection = { hovered: null, selected: null, seam: null };
    this.selectionListeners = new Set();
    this.drag = null;
    this.start3d();
    // The tools that say what the keys on the canvas do come before it.
    this.view3d.prepend(this.left);
    this.view3d.append(this.labels, this.tools, this.message);
    this.host3d.append(this.bottom);
    this.listenToDivider();
    onThemeChange(() => this.recolor());
  }

  start3d() {
    try {
      this.viewport = new Viewport(this.view3d, {
        label: "The shape in 3D. Arrow keys turn it, plus and minus zoom, 0 shows all.",
      });
    } catch {
      this.view3d.append(
        h("p", { class: "stage-message" }, "This browser cannot show 3D (WebGL is off). Everything else works."),
      );
      return;
    }
    this.viewport.onFrame((what, width, height) => {
      if (what === "resize") for (const shown of [this.result, this.drawn, this.input]) shown?.setResolution(width, height);
      this.placeLabels();
    });
    this.pickSoon = oncePerFrame((event) => this.hover(this.under(event)));
    const { canvas } = this.viewport;
    let pressed = null;
    canvas.addEventListener("pointermove", (event) => event.buttons === 0 && this.pickSoon(event));
    canvas.addEventListener("pointerleave", () => this.hover({ part: null, seam: null }));
    canvas.addEventListener("pointerdown", (event) => {
      pressed = [event.clientX, event.clientY];
    });
    canvas.addEventListener("pointerup", (event) => {
      const still = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 4;
      if (still && this.result) this.choose(this.under(event));
    });
  }

  clear(message = "") {
    this.stopDrawing();
    this.remove("drawn");
    this.remove("input");
    this.remove("result");
    this.setFlat(false);
    replace(this.labels);
    this.labels.classList.remove("covered");
    replace(this.tools);
    replace(this.bottom);
    this.message.hidden = !message;
    this.message.textContent = message;
    this.element.classList.toggle("empty", !message);
    this.viewport?.draw();
  }

  remove(which) {
    if (!this[which]) return;
    this.viewport?.root.remove(this[which].group);
    this[which].dispose();
    this[which] = null;
  }

  /**
   * Shows an uploaded mesh. onUp is told when the person turns it upright. `guides` are what is drawn on it; they may be
   * changed here when `drawing`.
   */
  showInput(mesh, { up, scale, onUp, places = [], guides = null, drawing = false }) {
    this.clear();
    this.element.classList.remove("empty");
    if (!this.viewport) return;
    this.input = new InputObject(mesh);
    this.input.setResolution(this.view3d.clientWidth, this.view3d.clientHeight);
    this.viewport.root.add(this.input.group);
    this.viewport.setUp(up);
    this.up = up;
    this.viewport.fit(this.input.radius * 1.12);
    this.viewport.home();
    this.markPlaces(places);
    this.turnTo(places);
    this.setScale(scale);
    replace(this.tools, this.viewTools(onUp));
    if (guides) this.showGuides(guides);
    if (guides && drawing) this.startDrawing(guides);
  }

  showGuides(guides) {
    this.drawn = new GuideObject(this.input.mesh.center);
    this.drawn.setResolution(this.view3d.clientWidth, this.view3d.clientHeight);
    this.viewport.root.add(this.drawn.group);
    const update = (preview = [], chosen = null) => {
      this.drawn?.show([...guides.list, ...preview], chosen);
      this.viewport.draw();
    };
    this.drawn.update = update;
    update();
  }

  /** Lights up one of the strokes; null = none. */
  chooseStroke(stroke) {
    this.drawn?.update([], stroke);
  }

  startDrawing(guides) {
    const pen = new Pen(this.viewport, this.input, {
      onPreview: (strokes) => this.drawn.update(strokes),
      onStrokes: (strokes) => guides.add(...strokes),
      scale: () => this.scale,
    });
    const tools = drawTools(pen, guides, () => this.scale);
    replace(this.left, tools.element);
    const stop = guides.onChange(() => this.drawn.update());
    this.drawTools = tools;
    this.stopDrawing = () => {
      this.drawTools = null;
      for (const end of [stop, () => pen.dispose(), () => tools.dispose()]) end();
      replace(this.left);
      this.stopDrawing = () => {};
    };
  }
  stopDrawing = () => {};

  /** Millimetres for one unit: the sizes beside the box follow. */
  setScale(scale) {
    this.scale = scale;
    this.drawTools?.update();
    if (!this.input || this.result) return;
    const sizes = extents(this.input.mesh);
    const places = this.viewport.edges(sizes.map((size) => size / 2));
    this.marked = ["x", "y", "z"].map((axis, k) => ({
      at: places[k],
      element: h("span", { class: `size-label axis-${axis}` }, millimetres(sizes[k] * scale)),
    }));
    replace(
      this.labels,
      this.marked.map((mark) => mark.element),
    );
    this.placeLabels();
  }

  /** Buttons that every view has. */
  viewTools(onUp) {
    const up = h(
      "select",
      {
        "aria-label": "Which way is up",
        onchange: () => {
          this.up = up.value;
          this.viewport.setUp(this.up);
          this.setScale(this.scale);
          this.viewport.home();
          onUp?.(this.up);
        },
      },
      UPS.map((axis) => h("option", { value: axis, selected: axis === this.up }, `${axis.replace("-", "−")} up`)),
    );
    const fit = h(
      "button",
      {
        type: "button",
        class: "tool",
        title: "Show all (0)",
        "aria-label": "Show all",
        onclick: () => {
          const { center, radius } = this.result?.ball() ?? { radius: this.input.radius * 1.12 };
          this.viewport.fit(radius, center);
          this.viewport.home();
        },
      },
      icon("fit", 18),
    );
    return [fit, h("label", { class: "tool up", title: "Lies on its side? Choose the axis that points up" }, icon("cube", 18), up)];
  }

  placeLabels() {
    if (!this.viewport) return;
    for (const { at, normal, element } of this.marked ?? []) {
      const behind = normal && this.result?.closed && !this.viewport.faces(at, normal);
      const pixel = behind ? null : this.viewport.project(at);
      element.hidden = !pixel;
      if (pixel)
        element.style.transform = `translate(${pixel[0].toFixed(1)}px, ${pixel[1].toFixed(1)}px) translate(-50%, -50%)`;
    }
  }

  /** Shows a result: parts in 3D beside the flat layout. `mesh` = the input, if it is to be had. */
  showResult(model, { up, mesh, onUp }) {
    this.clear();
    this.element.classList.remove("empty");
    this.marked = [];
    this.model = model;
    this.setFlat(true);
    this.flat ??= new FlatView(this.hostFlat, { onHover: (at) => this.hover(at), onSelect: (at) => this.choose(at) });
    this.flat.show(model);
    this.selection = { hovered: null, selected: null, seam: null };
    if (!this.viewport) return;
    this.result = new ResultObject(model);
    this.result.setResolution(this.view3d.clientWidth, this.view3d.clientHeight);
    this.viewport.root.add(this.result.group);
    if (mesh) this.addOverlay(mesh);
    this.showDrawn(model);
    this.viewport.setUp(up);
    this.up = up;
    this.viewport.fit(this.result.ball().radius);
    this.viewport.home();
    replace(this.tools, this.viewTools(onUp));
  }

  /** What was drawn on the mesh goes with the overlay. */
  showDrawn({ layout, center }) {
    const { list } = new Guides(layout.guides);
    if (list.length === 0) return;
    this.drawn = new GuideObject(center);
    this.drawn.setResolution(this.view3d.clientWidth, this.view3d.clientHeight);
    this.drawn.show(list);
    this.drawn.group.visible = false;
    this.viewport.root.add(this.drawn.group);
  }

  /** The input over the result, hidden at first; both are drawn around the result's centre. */
  addOverlay(mesh) {
    this.input = new InputObject(mesh);
    this.input.asGhost(true);
    this.input.group.position.set(...mesh.center.map((value, axis) => value - this.model.center[axis]));
    this.input.group.visible = false;
    this.viewport.root.add(this.input.group);
  }

  /** Balls at places of the result, or of the mesh as long as there is none; relative to its centre. */
  markPlaces(points) {
    const shown = this.result ?? this.input;
    shown?.marks.show(points, this.result ? this.model.radius : shown.radius);
    this.labels.classList.toggle("covered", points.length > 0 && !this.result); // sizes would hide the marks
    this.viewport?.draw();
  }

  /** Turns the shape so that what is marked lies in front. */
  turnTo(places) {
    if (places.length > 0) this.viewport?.turnTo(middleOf(places));
  }

  /** Poses the parts and keeps them in sight. */
  pose(state) {
    if (!this.result) return;
    const before = this.result.state;
    const leaving = before.fold >= 1 && state.fold !== undefined && state.fold < 1;
    const axes = leaving || state.only !== undefined ? this.viewport.screenAxes() : null;
    this.result.pose({ ...state, ...(axes ? { x: axes[0], y: axes[1] } : {}) });
    this.markSelection();
    const { center, radius } = this.result.ball();
    this.viewport.refit(radius, center);
  }

  under(event) {
    if (!this.result) return { part: null, seam: null };
    const hit = this.viewport.pick(event, [this.result.front, this.result.back]);
    if (!hit) return { part: null, seam: null };
    const at = this.result.group.worldToLocal(hit.point.clone()).toArray();
    return this.result.partAt(hit, 6 * this.viewport.pixelSize(at));
  }

  hover({ part, seam }) {
    if (part === this.selection.hovered && seam === this.hoveredSeam) return;
    this.hoveredSeam = seam;
    this.setSelection({ hovered: part });
  }

  /** A part (index) or, where the pointer meets one, a seam; the same again lets go. */
  choose({ part, seam }) {
    if (seam !== null && seam !== undefined) {
      return this.setSelection({ seam: seam === this.selection.seam ? null : seam, selected: null });
    }
    this.setSelection({ selected: part === this.selection.selected ? null : part, seam: null });
  }

  setSelection(change) {
    Object.assign(this.selection, change);
    const lit = {
      ...this.selection,
      seam: this.selection.seam ?? this.hoveredSeam ?? null,
      chosenSeam: this.selection.seam,
    };
    this.result?.highlight(lit);
    this.flat?.highlight(lit);
    if (change.selected !== undefined || change.seam !== undefined) this.markSelection();
    if (change.selected !== undefined && change.selected !== null) {
      this.flat?.reveal(change.selected);
      const { only = null } = this.result?.state ?? {};
      if (only !== null && only !== change.selected) this.pose({ only: change.selected });
    }
    this.viewport?.draw();
    for (const listener of this.selectionListeners) listener(this.selection);
  }

  onSelection(listener) {
    this.selectionListeners.add(listener);
    return () => this.selectionListeners.delete(listener);
  }

  /** Numbers in the 3D view: of the chosen part's seams, or of the chosen seam. */
  markSelection() {
    if (!this.result) return;
    const { selected, seam } = this.selection;
    const { parts, seams } = this.model;
    const tag = (text, id) =>
      h("span", { class: "seam-tag", onclick: () => this.choose({ part: null, seam: id }) }, text);
    const joined = (part) => seam !== null && part.seams.includes(seam);
    const shown = selected !== null ? [parts[selected]] : parts.filter(joined);
    this.marked = shown.flatMap((part) =>
      seamPlaces(part, this.result.position, 3)
        .filter((place) => selected !== null || place.seam === seam)
        .map((place) => ({
          at: place.at,
          normal: this.result.normalOf(place.vertex),
          element: tag(seams.find((item) => item.id === place.seam)?.name ?? place.seam, place.seam),
        })),
    );
    replace(
      this.labels,
      this.marked.map((mark) => mark.element),
    );
    this.placeLabels();
  }

  recolor() {
    this.input?.recolor();
    this.drawn?.recolor();
    this.result?.recolor();
    this.viewport?.draw();
  }

  setFlat(on) {
    this.hostFlat.hidden = this.divider.hidden = !on;
    this.element.classList.toggle("split", on);
  }

  listenToDivider() {
    const set = (share) => {
      const clamped = Math.min(0.8, Math.max(0.2, share));
      this.element.style.setProperty("--split", `${(clamped * 100).toFixed(1)}%`);
      this.divider.setAttribute("aria-valuenow", (clamped * 100).toFixed(0));
      this.share = clamped;
    };
    this.share = 0.5;
    const upright = matchMedia(UPRIGHT);
    const turn = () => this.divider.setAttribute("aria-orientation", upright.matches ? "horizontal" : "vertical");
    upright.addEventListener("change", turn);
    turn();
    this.divider.addEventListener("pointerdown", (event) => this.divider.setPointerCapture(event.pointerId));
    this.divider.addEventListener("pointermove", (event) => {
      if (!this.divider.hasPointerCapture(event.pointerId)) return;
      const box = this.element.getBoundingClientRect();
      set(upright.matches ? (event.clientY - box.top) / box.height : (event.clientX - box.left) / box.width);
    });
    this.divider.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.04, ArrowUp: -0.04, ArrowRight: 0.04, ArrowDown: 0.04 }[event.key];
      if (!step) return;
      event.preventDefault();
      set(this.share + step);
    });
  }
}
