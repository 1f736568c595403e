// Drawing on the mesh without a pointer: a cross over the 3D window that arrow keys move; Enter sets a point.
import { announce, h } from "../dom.js";
import { millimetres } from "../format.js";
import { lengthOf } from "../guides.js";

const STEP = 8; // pixels for a press of an arrow key
const NEAR = 10; // pixels: a point so near to the first one closes the line
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class KeyPen {
  points = []; // {place, way}: places on the surface from the point before to this one
  at = null; // pixel of the cross
  onShown = () => {};

  /** @param pen whose mode, brush and ways it shares  @param scale() millimetres for one unit */
  constructor(pen, scale) {
    Object.assign(this, { pen, scale, viewport: pen.viewport });
    this.cross = h("div", { class: "cross", hidden: true }, h("div", { class: "cross-ring" }));
    const { host, canvas } = this.viewport;
    host.append(this.cross);
    // A change of window or view moves neither the points nor what is under the cross by itself.
    const ends = [this.viewport.onFrame((what) => what === "resize" && this.keepInside())];
    const listen = (target, name, listener, capture = false) => {
      target.addEventListener(name, listener, capture);
      ends.push(() => target.removeEventListener(name, listener, capture));
    };
    listen(host, "keydown", (event) => this.key(event), true);
    listen(canvas, "focus", () => canvas.matches(":focus-visible") && this.show());
    listen(canvas, "blur", () => this.hide());
    listen(host, "pointerdown", () => this.hide(), true);
    this.stop = () => ends.forEach((end) => end());
  }

  get drawing() {
    return this.pen.mode !== "turn";
  }
  get shown() {
    return !this.cross.hidden;
  }

  show() {
    if (!this.drawing) return;
    const { clientWidth, clientHeight } = this.viewport.host;
    this.at ??= [clientWidth / 2, clientHeight / 2];
    this.cross.hidden = false;
    this.place();
    this.onShown();
  }

  /** What has been drawn stays. */
  hide() {
    if (!this.shown) return;
    this.end();
    this.cross.hidden = true;
    this.onShown();
  }

  key(event) {
    if (!this.drawing || event.target !== this.viewport.canvas || event.altKey) return;
    const { key } = event;
    const mine = () => {
      event.preventDefault();
      event.stopPropagation();
    };
    if ((event.ctrlKey || event.metaKey) && key.toLowerCase() === "z" && this.points.length > 0) {
      mine();
      return this.back();
    }
    if (event.ctrlKey || event.metaKey) return;
    if (ARROWS[key] && event.shiftKey) return this.showSoon(); // turns the view
    const actions = {
      Enter: () => this.set(),
      " ": () => this.set(),
      Backspace: () => this.back(),
      ...(this.points.length > 0 && { Escape: () => this.end() }),
    };
    const action = ARROWS[key] ? () => this.move(ARROWS[key]) : actions[key];
    if (!action) return;
    mine();
    if (this.shown) action();
    else this.show(); // where it is, before it does anything
  }

  /** After the view has turned. */
  showSoon() {
    this.show();
    requestAnimationFrame(() => this.preview());
  }

  move([x, y]) {
    this.at = [this.at[0] + STEP * x, this.at[1] + STEP * y];
    this.keepInside();
    this.preview();
  }

  keepInside() {
    if (!this.at) return;
    const { clientWidth, clientHeight } = this.viewport.host;
    this.at = [Math.min(clientWidth - 1, Math.max(0, this.at[0])), Math.min(clientHeight - 1, Math.max(0, this.at[1]))];
    this.place();
  }

  /** The cross, and around it the brush. */
  place() {
    const size = this.pen.mode === "keep_out" ? (2 * this.pen.radius) / this.viewport.pixelSize([0, 0, 0]) : 0;
    const ring = this.cross.firstChild;
    ring.hidden = size === 0;
    ring.style.width = ring.style.height = `${size}px`;
    this.cross.style.transform = `translate(${this.at[0]}px, ${this.at[1]}px)`;
  }

  set() {
    const place = this.pen.look(...this.at);
    if (!place) return announce("The cross is beside the shape. Move it onto the shape first.");
    if (this.closes()) {
      this.points.push({ place: this.points[0].place, way: this.wayTo(this.at) });
      return this.end();
    }
    const runs = this.trail().runs.length;
    this.points.push({ place, way: this.wayTo(this.at) });
    this.preview();
    const trail = this.trail();
    if (trail.runs.length > runs) announce("On the way there the shape ends, so another line begins here.");
    else if (this.points.length === 1) announce("First point set. Move on and press Enter for the next.");
    else announce(`Point ${this.points.length}, ${this.words(trail)}. Escape ends the line.`);
  }

  closes() {
    if (this.pen.mode !== "seam" || this.points.length < 3) return false;
    const first = this.viewport.project(this.points[0].place);
    return first !== null && Math.hypot(first[0] - this.at[0], first[1] - this.at[1]) < NEAR;
  }

  back() {
    if (this.points.length === 0) return announce("There is no point to take back.");
    this.points.pop();
    this.preview();
    announce(this.points.length > 0 ? `Point taken back, ${this.points.length} left` : "Point taken back, none left");
  }

  /** The line is done; without a length it is none. */
  end() {
    if (this.points.length === 0) return;
    const trail = this.trail();
    const { kind, strokes } = { kind: this.pen.mode, strokes: this.pen.strokesOf(trail) };
    this.points = [];
    this.pen.onPreview([]);
    if (strokes.length === 0) return announce("Nothing drawn: a seam needs two points.");
    this.pen.onStrokes(strokes);
    announce(kind === "seam" ? `Seam drawn, ${this.words(trail)}` : "Area without seams painted");
  }

  words(trail) {
    const length = trail.runs.reduce((sum, points) => sum + (points.length > 1 ? lengthOf({ points }) : 0), 0);
    return `${millimetres(length * this.scale())} long`;
  }

  /** What the surface shows from the last point, wherever it stands by now, to a pixel. */
  wayTo(pixel) {
    this.pen.picker.keepUp(this.pen.input.surface);
    const last = this.points.at(-1);
    const from = last ? this.viewport.project(last.place) : null;
    return this.pen.places(from ?? pixel, pixel);
  }

  trail(more = []) {
    const trail = this.pen.newTrail();
    for (const { way } of this.points) for (const place of way) trail.add(place);
    for (const place of more) trail.add(place);
    return trail;
  }

  /** What is set, and how the line would go on. */
  preview() {
    if (!this.shown) return;
    this.place();
    const next = this.points.length > 0 || this.pen.mode === "keep_out" ? this.wayTo(this.at) : [];
    this.pen.onPreview(this.pen.strokesOf(this.trail(next)));
  }

  dispose() {
    this.stop();
    this.cross.remove();
  }
}
