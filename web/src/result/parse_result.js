// ruled.obj and layout.json as one model: parts with their triangles, outline, rulings, seams, in 3D and flat.

import { bend } from "./fold.js";

/**
 * @typedef {object} Part
 * @property {number} id        as in layout.json
 * @property {string} label     what is printed on it
 * @property {number} begin     first vertex in the model's arrays
 * @property {number} end       one past the last vertex
 * @property {Uint32Array} triangles  three local vertices each (global numbering of the model)
 * @property {Uint32Array} outline    the closed outline, counter-clockwise, first not repeated
 * @property {Uint32Array} rulings    pairs of vertices: the bend lines to draw, of rulingCount in all
 * @property {number[]} seams   ids of the arches around it, each once
 * @property {number[]} tips    vertices of the outline at which a seam of the part with itself ends inside it
 * @property {number} area      mm²
 * @property {number[]} box     minU, minV, maxU, maxV in mm
 */

/** Splits the text of an OBJ file; only the records that a result has. */
function parseRuledObj(text) {
  const points = [];
  const uvs = [];
  const groups = new Map();
  let faces = null;
  for (let from = 0; from < text.length;) {
    let end = text.indexOf("\n", from);
    if (end < 0) end = text.length;
    const kind = text.charCodeAt(from);
    if (kind === 118) {
      // v, vt
      const words = text.slice(from, end).split(/\s+/);
      if (words[0] === "v") points.push(Number(words[1]), Number(words[2]), Number(words[3]));
      if (words[0] === "vt") uvs.push(Number(words[1]), Number(words[2]));
    } else if (kind === 103) {
      // g patch_<id>
      const id = Number(/^g\s+patch_(\d+)/.exec(text.slice(from, end))?.[1]);
      if (!groups.has(id)) groups.set(id, []);
      faces = groups.get(id);
    } else if (kind === 102 && faces) {
      // f v/vt v/vt v/vt
      for (const word of text
        .slice(from + 1, end)
        .trim()
        .split(/\s+/)) {
        const slash = word.indexOf("/");
        faces.push(Number(word.slice(0, slash)) - 1, Number.parseInt(word.slice(slash + 1), 10) - 1);
      }
    }
    from = end + 1;
  }
  return { points, uvs, groups };
}

/** The model of a result. Positions are relative to `center`, in units of the mesh; flat coordinates in mm. */
export function parseResult(objText, layout) {
  const { points, uvs, groups } = parseRuledObj(objText);
  const center = middle(points);
  const arrays = { position: [], flat: [], source: [] };
  const archOfEdge = archEdges(layout.arches);
  const parts = layout.patches.map((patch) =>
    makePart(patch, groups.get(patch.id) ?? [], { points, uvs, center, arrays, archOfEdge }),
  );
  const model = {
    layout,
    parts,
    center,
    scale: layout.scale ?? 1,
    position: Float64Array.from(arrays.position),
    flat: Float64Array.from(arrays.flat),
    source: Uint32Array.from(arrays.source),
    seams: layout.arches.map((arch) => makeSeam(arch, points, layout)),
    colors: colorsOf(layout),
  };
  model.partOfVertex = new Int32Array(model.source.length);
  parts.forEach((part, k) => model.partOfVertex.fill(k, part.begin, part.end));
  model.radius = radiusOf(model.position);
  model.partIndex = new Map(parts.map((part, k) => [part.id, k]));
  return model;
}

const TINY = 2; // millimetres

/** Whether a part is too narrow to be cut and held: on average, for slivers lie askew. */
export const isTiny = ({ area, box: [x0, y0, x1, y1] }) => area < TINY * Math.max(x1 - x0, y1 - y0);

function middle(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; k++) {
    low[k % 3] = Math.min(low[k % 3], points[k]);
    high[k % 3] = Math.max(high[k % 3], points[k]);
  }
  return low.map((value, axis) => (value + high[axis]) / 2);
}

function radiusOf(position) {
  let squared = 0;
  for (let k = 0; k < position.length; k += 3) {
    squared = Math.max(squared, position[k] ** 2 + position[k + 1] ** 2 + position[k + 2] ** 2);
  }
  return Math.sqrt(squared) || 1;
}

const edgeKey = (a, b) => (a < b ? `${a},${b}` : `${b},${a}`);

function archEdges(arches) {
  const map = new Map();
  for (const arch of arches) {
    for (let k = 0; k + 1 < arch.vertices.length; k++)
      map.set(edgeKey(arch.vertices[k], arch.vertices[k + 1]), arch.id);
  }
  return map;
}

function makeSeam(arch, points, layout) {
  let length = 0;
  for (let k = 0; k + 1 < arch.vertices.length; k++) {
    const [a, b] = [3 * arch.vertices[k], 3 * arch.vertices[k + 1]];
    length += Math.hypot(points[a] - points[b], points[a + 1] - points[b + 1], points[a + 2] - points[b + 2]);
  }
  const [p, q] = arch.patches;
  return {
    id: arch.id,
    name: arch.label ?? String(arch.id + 1),
    parts: [p, q],
    border: q === null,
    self: p === q,
    length: length * (layout.scale ?? 1),
  };
}

function makePart(patch, corners, { points, uvs, center, arrays, archOfEdge }) {
  const begin = arrays.source.length;
  const local = new Map(); // vt -> vertex of the model
  const triangles = [];
  for (let k = 0; k < corners.length; k += 2) {
    const [v, vt] = [corners[k], corners[k + 1]];
    if (!local.has(vt)) {
      local.set(vt, arrays.source.length);
      arrays.source.push(v);
      arrays.position.push(points[3 * v] - center[0], points[3 * v + 1] - center[1], points[3 * v + 2] - center[2]);
      arrays.flat.push(uvs[2 * vt], uvs[2 * vt + 1]);
    }
    triangles.push(local.get(vt));
  }
  const part = {
    id: patch.id,
    label: patch.label ?? String(patch.id),
    mirrorOf: patch.mirror_of ?? null,
    sheet: patch.sheet ?? 0,
    begin,
    end: arrays.source.length,
    triangles: Uint32Array.from(triangles),
  };
  const edges = sidesOf(part.triangles);
  part.outline = outlineOf(edges);
  part.outlineSeams = Int32Array.from(part.outline, (v, k) => {
    const w = part.outline[(k + 1) % part.outline.length];
    return archOfEdge.get(edgeKey(arrays.source[v], arrays.source[w])) ?? -1;
  });
  part.seams = [...new Set(part.outlineSeams)].filter((id) => id >= 0);
  part.tips = tipsOf(part.outline, arrays.source);
  part.rulingCount = (patch.rulings ?? []).length;
  part.rulings = thinned(rulingsOf(patch.rulings ?? [], edges, arrays.source), arrays.position);
  part.inner = [...edges.values()].filter((edge) => edge.length === 2);
  measureFlat(part, arrays.flat);
  return part;
}

/** Undirected edge -> the triangles' sides [a, b, opposite corner, triangle] along it. */
function sidesOf(triangles) {
  const edges = new Map();
  for (let k = 0; k < triangles.length; k += 3) {
    for (let side = 0; side < 3; side++) {
      const [a, b, c] = [triangles[k + side], triangles[k + ((side + 1) % 3)], triangles[k + ((side + 2) % 3)]];
      const key = edgeKey(a, b);
      if (!edges.has(key)) edges.set(key, []);
      edges.get(key).push([a, b, c, k / 3]);
    }
  }
  return edges;
}

function outlineOf(edges) {
  const next = new Map();
  for (const sides of edges.values()) if (sides.length === 1) next.set(sides[0][0], sides[0][1]);
  const loop = [];
  const [start] = next.keys();
  for (let v = start; v !== undefined && loop.length <= next.size; v = next.get(v)) {
    loop.push(v);
    if (next.get(v) === start) break;
  }
  return Uint32Array.from(loop);
}

/** Where the outline turns back along the same edge of the shape: the seam of the part with itself ends inside it. */
function tipsOf(outline, source) {
  const n = outline.length;
  return Array.from(outline).filter((_, k) => source[outline[(k + n - 1) % n]] === source[outline[(k + 1) % n]]);
}

/** Degrees of bend between two lines that are drawn: more lines would tell a person nothing. */
export const BEND_STEP = 4;

/** Of rulings in the order of the sweep, those to draw, as pairs of vertices: one for every BEND_STEP degrees. */
function thinned(rulings, position) {
  const out = [];
  let turned = (BEND_STEP * Math.PI) / 360; // the first one after half a step
  for (const [first, second] of rulings) {
    turned += Math.abs(bend(position, first[0], first[1], first[2], second[2]));
    if (turned < (BEND_STEP * Math.PI) / 180) continue;
    out.push(first[0], first[1]);
    turned = 0;
  }
  return Uint32Array.from(out);
}

/**
 * The two sides of each ruling. Rulings name vertices of ruled.obj; a part glued to itself may hold such a vertex twice,
 * so look for the edge.
 */
function rulingsOf(rulings, edges, source) {
  const bySource = new Map();
  for (const [first, second] of edges.values()) {
    if (second) bySource.set(edgeKey(source[first[0]], source[first[1]]), [first, second]);
  }
  return rulings.map(([i, j]) => bySource.get(edgeKey(i, j))).filter(Boolean);
}

function measureFlat(part, flat) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  let twice = 0;
  part.outline.forEach((v, k) => {
    const w = part.outline[(k + 1) % part.outline.length];
    const [x, y] = [flat[2 * v], flat[2 * v + 1]];
    twice += x * flat[2 * w + 1] - y * flat[2 * w];
    box[0] = Math.min(box[0], x);
    box[1] = Math.min(box[1], y);
    box[2] = Math.max(box[2], x);
    box[3] = Math.max(box[3], y);
  });
  part.area = Math.abs(twice) / 2;
  part.box = box;
}

/** A colour number per part so that neighbours differ: greedy, most neighbours first, least used colour preferred. */
export function colorsOf(layout, colors = 8) {
  const neighbours = new Map(layout.patches.map((patch) => [patch.id, new Set()]));
  for (const {
    patches: [p, q],
  } of layout.arches) {
    if (q === null || p === q) continue;
    neighbours.get(p)?.add(q);
    neighbours.get(q)?.add(p);
  }
  const chosen = new Map();
  const used = new Array(colors).fill(0);
  const order = layout.patches
    .map((p) => p.id)
    .sort((a, b) => neighbours.get(b).size - neighbours.get(a).size || a - b);
  for (const id of order) {
    const taken = new Set([...neighbours.get(id)].map((n) => chosen.get(n)));
    let best = -1;
    for (let c = 0; c < colors; c++) if (!taken.has(c) && (best < 0 || used[c] < used[best])) best = c;
    if (best < 0) best = id % colors;
    chosen.set(id, best);
    used[best]++;
  }
  return layout.patches.map((patch) => chosen.get(patch.id));
}
