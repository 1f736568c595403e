// The result in the 3D window: parts in colours, seams, rulings, light on what is chosen, exploded and folded states.
import {
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Color,
  FrontSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
} from "three";
import { foldPart, foldSteps, hinges } from "../result/fold.js";
import { fatLines, setSegments } from "./fat_lines.js";
import { Marks } from "./marks.js";
import { partColor, themeColor } from "./theme.js";

export class ResultObject {
  constructor(model) {
    this.model = model;
    this.group = new Group();
    this.state = { explode: 0, fold: 1, only: null };
    this.position = Float32Array.from(model.position);
    this.work = Float64Array.from(model.position);
    this.hinges = model.parts.map((part) => hinges(part, model.position, model.flat));
    this.centers = model.parts.map((part) => centerOf(part, model.position));
    this.values = null;
    this.makeSurface();
    this.makeLines();
    this.marks = new Marks();
    this.group.add(this.marks.group);
    this.recolor();
    this.update();
  }

  makeSurface() {
    const { parts, source } = this.model;
    this.geometry = new BufferGeometry();
    this.geometry.setAttribute("position", new BufferAttribute(this.position, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(new Float32Array(source.length * 3), 3));
    this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(source.length * 3), 3));
    const total = parts.reduce((sum, part) => sum + part.triangles.length, 0);
    const index = new Uint32Array(total);
    let at = 0;
    for (const part of parts) {
      index.set(part.triangles, at);
      at += part.triangles.length;
    }
    this.index = index;
    this.geometry.setIndex(new BufferAttribute(index, 1));
    const offset = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    this.front = new Mesh(this.geometry, new MeshLambertMaterial({ side: FrontSide, vertexColors: true, ...offset }));
    // The inside is the same sheet, paler: one still sees which part it is.
    this.back = new Mesh(
      this.geometry,
      new MeshLambertMaterial({ side: BackSide, vertexColors: true, color: 0xbdbdbd, ...offset }),
    );
    this.group.add(this.front, this.back);
  }

  makeLines() {
    const outline = [];
    const rulings = [];
    for (const part of this.model.parts) {
      part.outline.forEach((v, k) => outline.push(v, part.outline[(k + 1) % part.outline.length]));
      rulings.push(...part.rulings);
    }
    this.outlinePairs = Uint32Array.from(outline);
    this.rulingPairs = Uint32Array.from(rulings);
    // Where hundreds of parts lie close together, wide lines would hide them.
    this.seams = fatLines(2.2 * Math.max(0.5, Math.min(1, Math.sqrt(60 / this.model.parts.length))));
    this.chosen = fatLines(5);
    this.chosen.renderOrder = 2;
    this.rulings = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity: 0.32 }));
    this.group.add(this.seams, this.rulings, this.chosen);
  }

  /** Width and height of the window in pixels, for lines of constant width. */
  setResolution(width, height) {
    this.seams.material.resolution.set(width, height);
    this.chosen.material.resolution.set(width, height);
  }

  show({ seams, rulings }) {
    this.seams.visible = seams;
    this.rulings.visible = rulings;
  }

  /**
   * How the parts stand: explode 0..1 moves them apart, fold 1 = the shape .. 0 = flat as in the layout facing
   * `axes` (right and up of the screen, directions of the model), only = index of the one part that is shown.
   */
  pose(state) {
    Object.assign(this.state, state);
    this.update();
  }

  update() {
    const { model, work, state } = this;
    const frame = this.flatFrame();
    const steps = foldSteps(state.fold);
    model.parts.forEach((part, k) => {
      if (state.only !== null && state.only !== k) return;
      foldPart(part, this.hinges[k], model.position, model.flat, model.scale, steps, frame, work);
      this.moveApart(part, k, steps);
    });
    this.position.set(work);
    this.updateIndex();
    this.geometry.attributes.position.needsUpdate = true;
    this.updateNormals();
    this.geometry.computeBoundingSphere();
    this.updateLines();
  }

  /** Parts that are not shown leave the index. */
  updateIndex() {
    const { only } = this.state;
    let begin = 0;
    for (let k = 0; k < (only ?? 0); k++) begin += this.model.parts[k].triangles.length;
    const count = only === null ? this.index.length : this.model.parts[only].triangles.length;
    this.geometry.setDrawRange(only === null ? 0 : begin, count);
  }

  moveApart(part, k, { push, travel }) {
    const share = Math.max(this.state.explode * travel, this.state.only === null ? push : 0) * 0.9;
    if (share === 0) return;
    for (let v = part.begin; v < part.end; v++) {
      for (let axis = 0; axis < 3; axis++) this.work[3 * v + axis] += this.centers[k][axis] * share;
    }
  }

  /** Where the flat layout lies: centred on the shape, facing the viewer. */
  flatFrame() {
    const { x = [1, 0, 0], y = [0, 1, 0], only } = this.state;
    const box = only === null ? this.flatBox() : this.model.parts[only].box;
    const [u, v] = [(box[0] + box[2]) / 2, (box[1] + box[3]) / 2];
    return { x, y, origin: x.map((value, axis) => -(u * value + v * y[axis]) / this.model.scale) };
  }

  flatBox() {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const part of this.model.parts) {
      for (const k of [0, 1]) {
        box[k] = Math.min(box[k], part.box[k]);
        box[k + 2] = Math.max(box[k + 2], part.box[k + 2]);
      }
    }
    return box;
  }

  /** {center, radius}: what holds all that is shown, in units of the mesh. */
  ball() {
    const { explode, fold, only } = this.state;
    if (only !== null) return this.partBall(only);
    const box = this.flatBox();
    const flat = Math.hypot(box[2] - box[0], box[3] - box[1]) / 2 / this.model.scale;
    const { push, travel } = foldSteps(fold);
    const solid = this.model.radius * (1 + 0.75 * Math.max(explode * travel, push));
    return { center: [0, 0, 0], radius: solid + (flat - solid) * (1 - travel) };
  }

  /** The same for one part as it stands now, around the middle of its box. */
  partBall(k) {
    const { begin, end } = this.model.parts[k];
    const p = this.position;
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (let v = begin; v < end; v++) {
      for (let axis = 0; axis < 3; axis++) {
        low[axis] = Math.min(low[axis], p[3 * v + axis]);
        high[axis] = Math.max(high[axis], p[3 * v + axis]);
      }
    }
    const center = low.map((value, axis) => (value + high[axis]) / 2);
    return { center, radius: Math.hypot(...center.map((value, axis) => high[axis] - value)) };
  }

  updateNormals() {
    const normal = this.geometry.attributes.normal.array;
    normal.fill(0);
    const p = this.position;
    for (let k = 0; k < this.index.length; k += 3) {
      const [a, b, c] = [3 * this.index[k], 3 * this.index[k + 1], 3 * this.index[k + 2]];
      const [ux, uy, uz] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
      const [vx, vy, vz] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
      const [nx, ny, nz] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      for (const at of [a, b, c]) {
        normal[at] += nx;
        normal[at + 1] += ny;
        normal[at + 2] += nz;
      }
    }
    for (let k = 0; k < normal.length; k += 3) {
      const size = Math.hypot(normal[k], normal[k + 1], normal[k + 2]) || 1;
      normal[k] /= size;
      normal[k + 1] /= size;
      normal[k + 2] /= size;
    }
    this.geometry.attributes.normal.needsUpdate = true;
  }

  pairsOf(all, which) {
    const { only } = this.state;
    if (only === null) return all;
    const part = this.model.parts[only];
    return which === "rulings" ? part.rulings : this.outlinePairs.filter((v) => v >= part.begin && v < part.end);
  }

  updateLines() {
    // All outlines came first, so there are never more.
    this.seams.geometry.setPositions(this.ends(this.pairsOf(this.outlinePairs, "outline")));
    this.rulings.geometry.setAttribute(
      "position",
      new BufferAttribute(this.ends(this.pairsOf(this.rulingPairs, "rulings")), 3),
    );
    this.rulings.geometry.computeBoundingSphere();
    this.updateChosen();
  }

  ends(vertices) {
    const out = new Float32Array(vertices.length * 3);
    vertices.forEach((v, k) => out.set(this.position.subarray(3 * v, 3 * v + 3), 3 * k));
    return out;
  }

  /** Lights up parts and a seam: indices of parts, id of a seam. */
  highlight({ hovered = null, selected = null, seam = null, chosenSeam = null }) {
    this.light = { hovered, selected, seam, chosenSeam };
    this.recolor();
    this.updateChosen();
  }

  updateChosen() {
    const { seam = null, selected = null } = this.light ?? {};
    const pairs = [];
    this.model.parts.forEach((part, k) => {
      if (this.state.only !== null && this.state.only !== k) return;
      part.outline.forEach((v, place) => {
        const wanted = seam !== null ? part.outlineSeams[place] === seam : selected === k;
        if (wanted) pairs.push(v, part.outline[(place + 1) % part.outline.length]);
      });
    });
    setSegments(this.chosen, this.ends(pairs));
  }

  /** Colours by a colour [r, g, b] (sRGB) per vertex instead of by part; null = by part. */
  setValues(colors) {
    this.values = colors;
    this.recolor();
  }

  recolor() {
    const { hovered = null, selected = null, chosenSeam = null } = this.light ?? {};
    const colors = this.geometry.attributes.color.array;
    const paper = new Color(themeColor("--stage"));
    const white = new Color(0xffffff);
    const seamParts = chosenSeam === null ? [] : (this.model.seams.find((item) => item.id === chosenSeam)?.parts ?? []);
    const color = new Color();
    this.model.parts.forEach((part, k) => {
      const dim = (selected !== null || chosenSeam !== null) && selected !== k && !seamParts.includes(part.id);
      for (let v = part.begin; v < part.end; v++) {
        if (this.values) color.setRGB(this.values[3 * v], this.values[3 * v + 1], this.values[3 * v + 2], "srgb");
        else color.set(partColor(this.model.colors[k]));
        if (dim) color.lerp(paper, 0.55);
        if (hovered === k) color.lerp(white, 0.3);
        color.toArray(colors, 3 * v);
      }
    });
    this.geometry.attributes.color.needsUpdate = true;
    this.back.material.emissive.set(themeColor("--sheet-back")).multiplyScalar(0.2);
    this.seams.material.color.set(themeColor("--seam"));
    this.rulings.material.color.set(themeColor("--seam"));
    this.chosen.material.color.set(themeColor("--accent"));
    this.marks.recolor();
  }

  /** Index of the part of a picked triangle, and the seam when the point is within `reach` of it. */
  partAt(hit, reach) {
    const part = this.model.partOfVertex[hit.face.a];
    const at = this.group.worldToLocal(hit.point.clone());
    const { outline, outlineSeams } = this.model.parts[part];
    let best = { seam: null, distance: reach };
    outline.forEach((v, k) => {
      const distance = toSegment(at, this.position, v, outline[(k + 1) % outline.length]);
      if (distance < best.distance && outlineSeams[k] >= 0) best = { seam: outlineSeams[k], distance };
    });
    return { part, seam: best.seam };
  }

  /** A vertex' normal as it stands now, out of the shape even when its faces look inwards. */
  normalOf(v) {
    this.turn ??= looksOut(this.model) ? 1 : -1;
    const { array } = this.geometry.attributes.normal;
    return [0, 1, 2].map((axis) => this.turn * array[3 * v + axis]);
  }

  /** Whether the parts close in on each other, so that what looks away is behind something. */
  get closed() {
    const { explode, fold, only } = this.state;
    return explode === 0 && fold >= 1 && only === null;
  }

  dispose() {
    this.marks.dispose();
    for (const object of [this.front, this.back, this.seams, this.rulings, this.chosen]) {
      object.geometry.dispose();
      object.material.dispose();
    }
  }
}

/** Whether most of the surface looks away from the shape's middle. */
function looksOut({ parts, position: p }) {
  let volume = 0;
  for (const { triangles } of parts) {
    for (let k = 0; k < triangles.length; k += 3) {
      const [a, b, c] = [3 * triangles[k], 3 * triangles[k + 1], 3 * triangles[k + 2]];
      volume +=
        p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
        p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
        p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
    }
  }
  return volume >= 0;
}

function centerOf(part, position) {
  const sum = [0, 0, 0];
  for (let v = part.begin; v < part.end; v++) for (let axis = 0; axis < 3; axis++) sum[axis] += position[3 * v + axis];
  return sum.map((value) => value / Math.max(1, part.end - part.begin));
}

function toSegment(at, p, i, j) {
  const a = [p[3 * i], p[3 * i + 1], p[3 * i + 2]];
  const e = [p[3 * j] - a[0], p[3 * j + 1] - a[1], p[3 * j + 2] - a[2]];
  const w = [at.x - a[0], at.y - a[1], at.z - a[2]];
  const t = Math.min(
    1,
    Math.max(0, (w[0] * e[0] + w[1] * e[1] + w[2] * e[2]) / (e[0] ** 2 + e[1] ** 2 + e[2] ** 2 || 1)),
  );
  return Math.hypot(w[0] - t * e[0], w[1] - t * e[1], w[2] - t * e[2]);
}
