// What a mesh looks like at a glance: its box, whether it is closed, how many pieces, where its borders run.

/**
 * Welds equal corners and describes the surface.
 * @param {Float64Array} points x, y, z of each vertex, units of the file
 * @param {Uint32Array} faces three indices a triangle
 * @returns positions relative to `center` (Float32, for drawing), welded indices, box, edges of borders as pairs of points
 */
export function inspect(points, faces) {
  const { ids, count } = weld(points);
  const positions = new Float32Array(3 * count);
  const box = boxOf(points, faces);
  const center = box.min.map((low, axis) => (low + box.max[axis]) / 2);
  for (let v = 0; v < ids.length; v++) {
    for (let axis = 0; axis < 3; axis++) positions[3 * ids[v] + axis] = points[3 * v + axis] - center[axis];
  }
  const indices = new Uint32Array(faces.length);
  for (let k = 0; k < faces.length; k++) indices[k] = ids[faces[k]];
  const edges = edgeCounts(indices, count);
  return {
    positions,
    indices,
    center,
    box,
    vertices: count,
    faces: indices.length / 3,
    pieces: pieces(indices, count),
    insideOut: looksInwards(positions, indices, edges.border.length === 0, box),
    borderEdges: edges.border.length / 2,
    crowdedEdges: edges.crowded.length / 2,
    borders: segments(edges.border, positions),
    crowded: segments(edges.crowded, positions),
  };
}

function boxOf(points, faces) {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  for (const v of faces) {
    for (let axis = 0; axis < 3; axis++) {
      const value = points[3 * v + axis];
      if (value < min[axis]) min[axis] = value;
      if (value > max[axis]) max[axis] = value;
    }
  }
  return { min, max };
}

/** One id for each distinct position (open addressing on the bits of the coordinates). */
function weld(points) {
  const total = points.length / 3;
  let size = 16;
  while (size < 2 * total) size *= 2;
  const table = new Int32Array(size).fill(-1);
  const words = new Int32Array(points.buffer, points.byteOffset, points.length * 2);
  const ids = new Uint32Array(total);
  const first = [];
  for (let v = 0; v < total; v++) {
    let hash = 0;
    for (let k = 0; k < 6; k++) hash = Math.imul(hash ^ words[6 * v + k], 0x9e3779b1) ^ (hash >>> 15);
    let slot = hash & (size - 1);
    while (table[slot] >= 0 && !samePoint(points, first[table[slot]], v)) slot = (slot + 1) & (size - 1);
    if (table[slot] < 0) {
      table[slot] = first.length;
      first.push(v);
    }
    ids[v] = table[slot];
  }
  return { ids, count: first.length };
}

function samePoint(points, a, b) {
  return (
    points[3 * a] === points[3 * b] &&
    points[3 * a + 1] === points[3 * b + 1] &&
    points[3 * a + 2] === points[3 * b + 2]
  );
}

/** Edges with one face (border) and with more than two (crowded), as pairs of vertices. */
function edgeCounts(indices, count) {
  const sides = new Float64Array(indices.length);
  for (let k = 0; k < indices.length; k++) {
    const a = indices[k];
    const b = indices[k % 3 === 2 ? k - 2 : k + 1];
    sides[k] = Math.min(a, b) * count + Math.max(a, b);
  }
  sides.sort();
  const border = [];
  const crowded = [];
  for (let k = 0; k < sides.length;) {
    let end = k + 1;
    while (end < sides.length && sides[end] === sides[k]) end++;
    const a = Math.floor(sides[k] / count);
    const b = sides[k] % count;
    if (end - k === 1 && a !== b) border.push(a, b);
    if (end - k > 2) crowded.push(a, b);
    k = end;
  }
  return { border, crowded };
}

/**
 * Whether the faces look inwards: exact for a closed surface (its volume is negative), a cautious guess for an open one,
 * which has an inside only when it is a good part of its box.
 */
function looksInwards(positions, indices, closed, { min, max }) {
  let [sum, total] = [0, 0];
  const p = positions;
  for (let k = 0; k < indices.length; k += 3) {
    const [a, b, c] = [3 * indices[k], 3 * indices[k + 1], 3 * indices[k + 2]];
    const volume =
      p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
      p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
      p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
    sum += volume;
    total += Math.abs(volume);
  }
  const box = max.reduce((product, high, axis) => product * (high - min[axis]), 1);
  return closed ? sum < 0 : sum < -0.5 * total && -sum / 6 > 0.2 * box;
}

function segments(pairs, positions) {
  const out = new Float32Array(pairs.length * 3);
  pairs.forEach((v, k) => out.set(positions.subarray(3 * v, 3 * v + 3), 3 * k));
  return out;
}

function pieces(indices, count) {
  const parent = Uint32Array.from({ length: count }, (_, k) => k);
  const root = (v) => {
    while (parent[v] !== v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (let k = 0; k < indices.length; k += 3) {
    parent[root(indices[k + 1])] = root(indices[k]);
    parent[root(indices[k + 2])] = root(indices[k]);
  }
  const roots = new Set();
  for (const v of indices) roots.add(root(v));
  return roots.size;
}
