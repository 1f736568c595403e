// The flat layout on a cutting mat: parts true to scale, pan and zoom, hover and choose parts and seams.
import { h, oncePerFrame, replace, s } from "../dom.js";
import { millimetres } from "../format.js";
import { labelPlace } from "../result/label_place.js";
import { seamPlaces } from "../result/seam_places.js";
import { spread } from "../result/spread.js";

const APART = 22; // pixels between the numbers of seams
const STEPS = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];

export class FlatView {
  /** @param {{onHover, onSelect}} events each called with ({part, seam}); part is an index or null, seam an id or null */
  constructor(host, { onHover, onSelect }) {
    this.host = host;
    this.events = { onHover, onSelect };
    this.svg = s("svg", {
      class: "flat",
      tabindex: "0",
      role: "group",
      "aria-label": "Flat layout. Arrow keys move it, plus and minus zoom.",
    });
    this.mat = s("g", { class: "mat" });
    this.content = s("g", {});
    this.svg.append(this.mat, this.content);
    this.bar = h("div", { class: "scale-bar", "aria-hidden": "true" });
    host.append(this.svg, this.bar);
    this.view = { x: 0, y: 0, zoom: 1 };
    this.apply = oncePerFrame(() => this.applyNow());
    this.listen();
    new ResizeObserver(() => this.onResize()).observe(host);
  }

  /** Shows a model of parse_result; colour numbers become classes. */
  show(model) {
    this.model = model;
    this.parts = model.parts.map((part, k) => this.makePart(part, k));
    replace(
      this.content,
      this.parts.map((item) => item.group),
    );
    this.fit();
  }

  makePart(part, k) {
    const { flat } = this.model;
    const at = (v) => `${flat[2 * v].toFixed(3)} ${(-flat[2 * v + 1]).toFixed(3)}`;
    const outline = `M${Array.from(part.outline, at).join("L")}Z`;
    let rulings = "";
    for (let r = 0; r < part.rulings.length; r += 2) rulings += `M${at(part.rulings[r])}L${at(part.rulings[r + 1])}`;
    const place = labelPlace(part.outline, flat);
    const label = s(
      "text",
      {
        class: "part-label",
        x: place.x.toFixed(2),
        y: (-place.y).toFixed(2),
        "text-anchor": "middle",
        "dominant-baseline": "central",
      },
      part.label,
    );
    const group = s(
      "g",
      { class: `part color-${this.model.colors[k]}`, "data-part": k },
      s("path", { class: "sheet", d: outline }),
      rulings && s("path", { class: "rulings", d: rulings }),
      s("path", { class: "cut", d: outline }),
      this.seamPaths(part, at),
      label,
    );
    const names = this.seamNames(part);
    group.append(...names.map(({ element }) => element));
    return { group, label, names, room: place.room };
  }

  /** The numbers of the part's seams; they show while the part is chosen. */
  seamNames(part) {
    return seamPlaces(part, this.model.flat, 2).map(({ seam, at: [x, y] }) => ({
      at: [x, -y],
      element: s(
        "text",
        { class: "seam-name", "data-seam": seam, "text-anchor": "middle", "dominant-baseline": "central" },
        this.model.seams.find((item) => item.id === seam)?.name ?? seam,
      ),
    }));
  }

  /** Those of the chosen part, none on another. */
  placeNames() {
    const names = this.parts?.[this.chosen]?.names ?? [];
    const places = spread(
      names.map(({ at }) => at),
      APART / this.view.zoom,
    );
    names.forEach(({ element }, k) => {
      element.setAttribute("x", places[k][0].toFixed(2));
      element.setAttribute("y", places[k][1].toFixed(2));
    });
  }

  /** One wide, unseen stroke per seam and part: what the pointer meets; it shows when the seam is chosen. */
  seamPaths(part, at) {
    const paths = new Map();
    part.outlineSeams.forEach((seam, k) => {
      if (seam < 0) return;
      const piece = `M${at(part.outline[k])}L${at(part.outline[(k + 1) % part.outline.length])}`;
      paths.set(seam, (paths.get(seam) ?? "") + piece);
    });
    return [...paths].map(([seam, d]) => s("path", { class: "seam", "data-seam": seam, d }));
  }

  highlight({ hovered = null, selected = null, seam = null, chosenSeam = null }) {
    if (!this.parts) return;
    const seamParts = seam === null ? [] : (this.model.seams.find((item) => item.id === seam)?.parts ?? []);
    this.parts.forEach(({ group }, k) => {
      group.classList.toggle("lit", hovered === k || seamParts.includes(this.model.parts[k].id));
      group.classList.toggle("chosen", selected === k);
    });
    this.chosen = selected;
    this.placeNames();
    this.content.classList.toggle("some", selected !== null || chosenSeam !== null);
    for (const path of this.content.querySelectorAll(".seam.lit")) path.classList.remove("lit");
    if (seam !== null)
      for (const path of this.content.querySelectorAll(`.seam[data-seam="${seam}"]`)) path.classList.add("lit");
  }

  showRulings(on) {
    this.content.classList.toggle("no-rulings", !on);
  }

  box() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const part of this.model.parts) {
      box[0] = Math.min(box[0], part.box[0]);
      box[1] = Math.min(box[1], -part.box[3]);
      box[2] = Math.max(box[2], part.box[2]);
      box[3] = Math.max(box[3], -part.box[1]);
    }
    return box;
  }

  fit(box = this.box()) {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (!width || !height || !this.model) return;
    const [w, d] = [Math.max(box[2] - box[0], 1e-6), Math.max(box[3] - box[1], 1e-6)];
    const zoom = Math.min((width - 40) / w, (height - 64) / d);
    this.view = {
      zoom,
      x: width / 2 - (zoom * (box[0] + box[2])) / 2,
      y: (height - 20) / 2 - (zoom * (box[1] + box[3])) / 2,
    };
    this.fitted = true;
    this.apply();
  }

  /** Brings a part into sight when it is outside or very small. */
  reveal(k) {
    const [u0, v0, u1, v1] = this.model.parts[k].box;
    const { x, y, zoom } = this.view;
    const inside =
      x + zoom * u0 >= 0 &&
      x + zoom * u1 <= this.host.clientWidth &&
      y - zoom * v1 >= 0 &&
      y - zoom * v0 <= this.host.clientHeight;
    if (!inside)
      this.fit([u0, -v1, u1, -v0].map((value, i) => value + (i < 2 ? -1 : 1) * 0.3 * Math.max(u1 - u0, v1 - v0)));
  }

  onResize() {
    if (!this.model) return;
    if (this.fitted) this.fit();
    else this.apply();
  }

  applyNow() {
    const { x, y, zoom } = this.view;
    this.content.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)}) scale(${zoom})`);
    for (const { label, room } of this.parts ?? []) {
      // Letters keep a readable size on screen as long as they fit into their part.
      const size = Math.min(13 / zoom, room * 0.9);
      label.setAttribute("font-size", size.toFixed(3));
      label.style.display = size * zoom < 6 ? "none" : "";
    }
    this.content.style.setProperty("--seam-name", `${(12 / zoom).toFixed(3)}px`);
    this.placeNames();
    this.drawMat();
  }

  /** The mat's lines: ten to a thick one, in round millimetres, and the bar that says how long one is. */
  drawMat() {
    const { x, y, zoom } = this.view;
    const { clientWidth: width, clientHeight: height } = this.host;
    const step = STEPS.find((mm) => mm * zoom >= 9) ?? STEPS.at(-1);
    let [fine, bold] = ["", ""];
    for (let k = Math.ceil(-x / zoom / step); k * step * zoom + x < width; k++) {
      const line = `M${(k * step * zoom + x).toFixed(1)} 0V${height}`;
      if (k % 10 === 0) bold += line;
      else fine += line;
    }
    for (let k = Math.ceil(-y / zoom / step); k * step * zoom + y < height; k++) {
      const line = `M0 ${(k * step * zoom + y).toFixed(1)}H${width}`;
      if (k % 10 === 0) bold += line;
      else fine += line;
    }
    replace(this.mat, s("path", { class: "fine", d: fine || "M0 0" }), s("path", { class: "bold", d: bold || "M0 0" }));
    this.bar.style.width = `${(10 * step * zoom).toFixed(1)}px`;
    this.bar.textContent = millimetres(10 * step);
  }

  zoomAt(factor, px, py) {
    const { x, y, zoom } = this.view;
    const next = Math.min(4000, Math.max(0.002, zoom * factor));
    const share = next / zoom;
    this.view = { zoom: next, x: px - (px - x) * share, y: py - (py - y) * share };
    this.fitted = false;
    this.apply();
  }

  pan(dx, dy) {
    this.view.x += dx;
    this.view.y += dy;
    this.fitted = false;
    this.apply();
  }

  listen() {
    const { svg } = this;
    svg.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        const box = svg.getBoundingClientRect();
        this.zoomAt(
          Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0015)),
          event.clientX - box.left,
          event.clientY - box.top,
        );
      },
      { passive: false },
    );
    svg.addEventListener("keydown", (event) => this.onKey(event));
    this.listenToPointers();
  }

  onKey(event) {
    const center = [this.host.clientWidth / 2, this.host.clientHeight / 2];
    const keys = {
      ArrowLeft: () => this.pan(40, 0),
      ArrowRight: () => this.pan(-40, 0),
      ArrowUp: () => this.pan(0, 40),
      ArrowDown: () => this.pan(0, -40),
      "+": () => this.zoomAt(1.25, ...center),
      "=": () => this.zoomAt(1.25, ...center),
      "-": () => this.zoomAt(0.8, ...center),
      0: () => this.fit(),
      Home: () => this.fit(),
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  }

  /** One pointer pans, two zoom; a press without a move chooses. */
  listenToPointers() {
    const pointers = new Map();
    let moved = 0;
    this.svg.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      if (pointers.size === 0) moved = 0;
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    this.svg.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return this.events.onHover(this.under(event));
      const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
      const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
      moved += Math.hypot(dx, dy);
      if (moved > 4 && !this.svg.hasPointerCapture(event.pointerId)) this.svg.setPointerCapture(event.pointerId);
      if (moved > 4 && others.length === 0) this.pan(dx, dy);
      if (others.length === 1) this.pinch(before, [event.clientX, event.clientY], others[0]);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    const end = (event) => {
      if (!pointers.delete(event.pointerId)) return;
      if (event.type === "pointerup" && moved <= 4 && pointers.size === 0) this.events.onSelect(this.under(event));
    };
    this.svg.addEventListener("pointerup", end);
    this.svg.addEventListener("pointercancel", end);
    this.svg.addEventListener("pointerleave", () => this.events.onHover({ part: null, seam: null }));
  }

  pinch(before, after, other) {
    const box = this.svg.getBoundingClientRect();
    const spread = (p) => Math.hypot(p[0] - other[0], p[1] - other[1]) || 1;
    this.zoomAt(
      spread(after) / spread(before),
      (after[0] + other[0]) / 2 - box.left,
      (after[1] + other[1]) / 2 - box.top,
    );
    this.pan((after[0] - before[0]) / 2, (after[1] - before[1]) / 2);
  }

  under(event) {
    const target = document.elementFromPoint(event.clientX, event.clientY);
    const group = target?.closest?.("[data-part]");
    if (!group || !this.content.contains(group)) return { part: null, seam: null };
    const seam = target.getAttribute("data-seam");
    return { part: Number(group.getAttribute("data-part")), seam: seam === null ? null : Number(seam) };
  }
}
