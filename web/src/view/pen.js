// Drawing on the mesh: a pointer that goes down on the surface leaves a stroke there; beside it, it turns the view.
import { Trail } from "../guides.js";
import { h } from "../dom.js";
import { DepthPicker } from "./depth_picker.js";
import { KeyPen } from "./key_pen.js";

const STEP = 0.012; // of the mesh's radius: from one place of a stroke to the next
const LEAP = 0.15; // of the mesh's radius: farther is another stroke
const PIXELS = 3; // between two looks at the surface
const DRAWS = {
  role: "application",
  label:
    "Drawing on the shape. Arrow keys move a cross, Enter sets a point, Backspace takes it back, Escape ends the line. " +
    "Shift and arrow keys turn the shape.",
};

export class Pen {
  mode = "turn"; // "turn", "seam", "keep_out"
  trail = null;

  /**
   * @param viewport @param input what is drawn on (an InputObject)
   * @param onPreview(strokes) while a stroke is drawn, none when it was given up  @param onStrokes(strokes) at its end
   * @param scale() millimetres for one unit
   */
  constructor(viewport, input, { onPreview, onStrokes, scale }) {
    Object.assign(this, { viewport, input, onPreview, onStrokes });
    this.picker = new DepthPicker(viewport);
    this.radius = input.radius * 0.12;
    this.ring = h("div", { class: "brush-ring", hidden: true });
    viewport.host.append(this.ring);
    this.replayed = new WeakSet();
    this.keys = new KeyPen(this, scale);
    const listeners = {
      pointerdown: (event) => this.down(event),
      pointermove: (event) => this.move(event),
      pointerup: (event) => this.up(event),
      pointercancel: () => this.giveUp(),
      pointerleave: () => this.showRing(null),
    };
    // Before the view's own listeners on the canvas: what draws does not turn.
    for (const [name, listener] of Object.entries(listeners)) viewport.host.addEventListener(name, listener, true);
    this.stop = () => {
      for (const [name, listener] of Object.entries(listeners)) viewport.host.removeEventListener(name, listener, true);
    };
  }

  setMode(mode) {
    this.giveUp();
    this.keys.hide();
    this.mode = mode;
    this.viewport.setUse(mode === "turn" ? null : DRAWS);
    this.viewport.canvas.classList.toggle("draws", mode !== "turn");
    this.showRing(null);
  }

  pixelOf(event) {
    const box = this.viewport.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  down(event) {
    if (this.mode === "turn" || event.target !== this.viewport.canvas || this.replayed.has(event)) return;
    if (this.trail) return this.turnInstead();
    if (event.pointerType === "mouse" && event.button !== 0) return;
    this.picker.capture(this.input.surface);
    this.pixel = this.pixelOf(event);
    const place = this.picker.at(...this.pixel);
    if (!place) return;
    event.stopPropagation();
    this.viewport.canvas.setPointerCapture(event.pointerId);
    this.begun = event;
    this.trail = this.newTrail();
    this.trail.add(place);
    this.preview();
  }

  move(event) {
    this.showRing(event);
    if (!this.trail || event.pointerId !== this.begun.pointerId) return;
    event.stopPropagation();
    const passed = event.getCoalescedEvents?.() ?? [];
    let grown = false;
    for (const each of passed.length > 0 ? passed : [event]) grown = this.follow(this.pixelOf(each)) || grown;
    if (grown) this.preview();
  }

  /** Looks at the surface all along the way of the pointer. */
  follow(pixel) {
    let grown = false;
    for (const place of this.places(this.pixel, pixel)) grown = this.trail.add(place) || grown;
    this.pixel = pixel;
    return grown;
  }

  /** What the picker saw from one pixel (not included) to another; null beside the surface. */
  places([x0, y0], [x, y]) {
    const steps = Math.max(1, Math.ceil(Math.hypot(x - x0, y - y0) / PIXELS));
    return Array.from({ length: steps }, (_, k) => {
      const t = (k + 1) / steps;
      return this.picker.at(x0 + (x - x0) * t, y0 + (y - y0) * t);
    });
  }

  /** The place under a pixel in the view as it is now. */
  look(x, y) {
    this.picker.keepUp(this.input.surface);
    return this.picker.at(x, y);
  }

  newTrail() {
    return new Trail(STEP * this.input.radius, LEAP * this.input.radius);
  }

  up(event) {
    if (!this.trail || event.pointerId !== this.begun.pointerId) return;
    event.stopPropagation();
    const strokes = this.strokesOf(this.trail);
    this.trail = null;
    this.onPreview([]);
    if (strokes.length > 0) this.onStrokes(strokes);
  }

  /** The strokes of a trail in the frame of the file, with as many digits as a mesh has. */
  strokesOf(trail) {
    const { center } = this.input.mesh;
    const inFile = (place) => place.map((value, axis) => Number((value + center[axis]).toPrecision(9)));
    return trail
      .strokes(this.mode, Number(this.radius.toPrecision(6)))
      .map((stroke) => ({ ...stroke, points: stroke.points.map(inFile) }));
  }

  preview() {
    this.onPreview(this.strokesOf(this.trail));
  }

  giveUp() {
    if (!this.trail) return;
    this.trail = null;
    this.onPreview([]);
  }

  /** A second finger: both together turn and zoom, so the view hears of the first one, too. */
  turnInstead() {
    const { begun } = this;
    this.giveUp();
    const first = new PointerEvent("pointerdown", {
      pointerId: begun.pointerId,
      pointerType: begun.pointerType,
      clientX: begun.clientX,
      clientY: begun.clientY,
      button: 0,
      buttons: 1,
      bubbles: true,
    });
    this.replayed.add(first);
    this.viewport.canvas.dispatchEvent(first);
  }

  /** The brush's size around the pointer; a finger hides it anyway. */
  showRing(event) {
    const shown = event && this.mode === "keep_out" && event.target === this.viewport.canvas;
    this.ring.hidden = !shown || event.pointerType === "touch";
    if (this.ring.hidden) return;
    const size = (2 * this.radius) / this.viewport.pixelSize([0, 0, 0]);
    const [x, y] = this.pixelOf(event);
    this.ring.style.width = this.ring.style.height = `${size}px`;
    this.ring.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
  }

  dispose() {
    this.stop();
    this.keys.dispose();
    this.ring.remove();
    this.viewport.setUse(null);
    this.viewport.canvas.classList.remove("draws");
  }
}
