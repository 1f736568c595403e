// What a person drew on a mesh: lines that become seams, and areas that seams keep out of. Places are in the units and
// the frame of the uploaded file, as they travel (part `guides` of an execution request).

import { Observable } from "./listeners.js";

/** A stroke as it is drawn: {kind: "seam", points, closed} or {kind: "keep_out", points, radius}; points are [x, y, z]. */
export class Guides extends Observable {
  list = [];
  past = []; // earlier lists, for undo

  constructor(wire = null) {
    super();
    if (wire) this.list = strokesOf(wire);
  }

  get empty() {
    return this.list.length === 0;
  }

  add(...strokes) {
    this.change([...this.list, ...strokes]);
  }
  remove(k) {
    this.change(this.list.filter((_, i) => i !== k));
  }
  clear() {
    if (!this.empty) this.change([]);
  }
  undo() {
    if (this.past.length === 0) return;
    this.list = this.past.pop();
    this.changed();
  }

  change(list) {
    this.past.push(this.list);
    this.list = list;
    this.changed();
  }
  /** As it is sent; null when nothing is drawn. */
  wire() {
    if (this.empty) return null;
    const seams = this.list.filter(({ kind }) => kind === "seam").map(({ points, closed }) => ({ points, closed }));
    const keep_out = this.list
      .filter(({ kind }) => kind === "keep_out")
      .map(({ points, radius }) => ({ points, radius }));
    return { seams, keep_out };
  }
}

function strokesOf({ seams = [], keep_out = [] }) {
  return [
    ...seams.map(({ points, closed = false }) => ({ kind: "seam", points, closed })),
    ...keep_out.map(({ points, radius }) => ({ kind: "keep_out", points, radius })),
  ];
}

/** Length of a stroke, in units of its points. */
export function lengthOf({ points, closed = false }) {
  let sum = 0;
  for (let k = 1; k < points.length; k++) sum += distance(points[k - 1], points[k]);
  return sum + (closed ? distance(points.at(-1), points[0]) : 0);
}

export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/**
 * Collects the places that a pointer passes. A jump farther than `leap` (over an edge that hides what is behind it, or
 * across a gap) begins a new run: what lies between was never touched.
 */
export class Trail {
  runs = [[]];

  /** @param step least distance between two places  @param leap largest */
  constructor(step, leap) {
    this.step = step;
    this.leap = leap;
  }

  /** A place on the surface, or null where the pointer is beside it. Returns whether something was added. */
  add(place) {
    const run = this.runs.at(-1);
    if (!place) {
      this.broken = run.length > 0;
      return false;
    }
    const last = run.at(-1);
    const gap = last ? distance(last, place) : 0;
    if (last && (gap > this.leap || (this.broken && gap > 3 * this.step))) this.runs.push([place]);
    else if (!last || gap >= this.step) run.push(place);
    else return false;
    this.broken = false;
    return true;
  }

  /** Strokes of what was drawn; a seam needs a length, an area may be a single dab. */
  strokes(kind, radius) {
    const runs = this.runs.filter((run) => run.length >= (kind === "seam" ? 2 : 1));
    if (kind === "keep_out") return runs.map((run) => ({ kind, points: thinned(run, radius / 8), radius }));
    return runs.map((run) => {
      const points = thinned(run, this.step / 4);
      const ends = distance(points[0], points.at(-1));
      const closed = points.length > 3 && ends < 4 * this.step && lengthOf({ points }) > 5 * ends;
      return { kind, points, closed };
    });
  }
}

/** The points without those that a straight line misses by less than `error` (Douglas and Peucker). */
export function thinned(points, error) {
  if (points.length < 3) return points;
  const keep = new Uint8Array(points.length);
  keep[0] = keep[points.length - 1] = 1;
  const open = [[0, points.length - 1]];
  while (open.length > 0) {
    const [a, b] = open.pop();
    let [worst, at] = [error, -1];
    for (let k = a + 1; k < b; k++) {
      const off = toSegment(points[k], points[a], points[b]);
      if (off > worst) [worst, at] = [off, k];
    }
    if (at < 0) continue;
    keep[at] = 1;
    open.push([a, at], [at, b]);
  }
  return points.filter((_, k) => keep[k]);
}

/** Distance of a point to the segment from a to b. */
export function toSegment(p, a, b) {
  const e = b.map((value, axis) => value - a[axis]);
  const w = p.map((value, axis) => value - a[axis]);
  const dot = (u, v) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const t = Math.min(1, Math.max(0, dot(w, e) / (dot(e, e) || 1)));
  return Math.hypot(...w.map((value, axis) => value - t * e[axis]));
}

/** Places along a stroke that are at most `step` apart, ends included: where the brush is set down. */
export function alongStroke(points, step) {
  const places = [points[0]];
  for (let k = 1; k < points.length; k++) {
    const [a, b] = [points[k - 1], points[k]];
    const n = Math.max(1, Math.ceil(distance(a, b) / step));
    for (let i = 1; i <= n; i++) places.push(a.map((value, axis) => value + ((b[axis] - value) * i) / n));
  }
  return places;
}
