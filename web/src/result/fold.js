// Bending sheets flat, exactly: each part is a tree of triangles, and turning every hinge by a share of its dihedral
// angle moves rigid triangles only. Every step between shape and sheet is therefore free of stretch.

/**
 * Prepares a part: the order in which triangles hang on each other and the angle of each hinge.
 * @param part of parse_result  @param position xyz of the model's vertices  @param flat uv in mm
 */
export function hinges(part, position, flat) {
  const count = part.triangles.length / 3;
  const around = Array.from({ length: count }, () => []);
  for (const [first, second] of part.inner) {
    around[first[3]].push({ to: second[3], side: first, other: second });
    around[second[3]].push({ to: first[3], side: second, other: first });
  }
  const root = middleTriangle(part, around, flat);
  const steps = [];
  const seen = new Uint8Array(count);
  const queue = [root];
  seen[root] = 1;
  for (let k = 0; k < queue.length; k++) {
    for (const { to, side, other } of around[queue[k]]) {
      if (seen[to]) continue;
      seen[to] = 1;
      queue.push(to);
      steps.push(step(queue[k], to, side, other[2], position, flat));
    }
  }
  return { root, steps, count };
}

/** The triangle in the middle of the tree by area, so that a part opens to both sides. */
function middleTriangle(part, around, flat) {
  const count = around.length;
  const order = [0];
  const parent = new Int32Array(count).fill(-1);
  for (let k = 0; k < order.length; k++) {
    for (const { to } of around[order[k]]) {
      if (to === parent[order[k]] || to === 0 || parent[to] >= 0) continue;
      parent[to] = order[k];
      order.push(to);
    }
  }
  const weight = new Float64Array(count);
  let total = 0;
  for (let t = 0; t < count; t++) {
    weight[t] = flatArea(part, t, flat);
    total += weight[t];
  }
  for (let k = order.length - 1; k > 0; k--) weight[parent[order[k]]] += weight[order[k]];
  let best = 0;
  for (const t of order) if (weight[t] >= total / 2 && weight[t] <= weight[best]) best = t;
  return best;
}

function flatArea(part, t, flat) {
  const [a, b, c] = [0, 1, 2].map((k) => 2 * part.triangles[3 * t + k]);
  return (
    Math.abs((flat[b] - flat[a]) * (flat[c + 1] - flat[a + 1]) - (flat[c] - flat[a]) * (flat[b + 1] - flat[a + 1])) / 2
  );
}

/** The hinge a-b from triangle `from` to `to`, whose third corner is c: foot and height of c, and the bend. */
function step(from, to, [a, b, opposite], c, position, flat) {
  const [ax, ay] = [flat[2 * a], flat[2 * a + 1]];
  const [ex, ey] = [flat[2 * b] - ax, flat[2 * b + 1] - ay];
  const length = Math.hypot(ex, ey);
  const [cx, cy] = [flat[2 * c] - ax, flat[2 * c + 1] - ay];
  return {
    from,
    to,
    a,
    b,
    c,
    along: (cx * ex + cy * ey) / (length * length), // share of the hinge's length
    height: Math.abs(cx * ey - cy * ex) / length, // mm, away from the triangle before
    angle: bend(position, a, b, opposite, c), // radians; 0 = flat, positive = towards the inside
  };
}

/** Signed angle between the triangles a-b-opposite (before) and b-a-c (after), from their positions. */
export function bend(position, a, b, opposite, c) {
  const edge = sub(position, b, a);
  const before = cross(edge, sub(position, opposite, a));
  const after = cross(sub(position, c, a), edge);
  const size = Math.hypot(...edge) || 1;
  return Math.atan2(dot(cross(before, after), edge) / size, dot(before, after));
}

function sub(p, i, j) {
  return [p[3 * i] - p[3 * j], p[3 * i + 1] - p[3 * j + 1], p[3 * i + 2] - p[3 * j + 2]];
}
function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
function unit(a) {
  const n = Math.hypot(...a) || 1;
  return [a[0] / n, a[1] / n, a[2] / n];
}

/**
 * The steps of unfolding everything, by `fold` from 1 (the shape) to 0 (the layout): parts move apart (push), then bend
 * flat (bend: share of the dihedral angles), then travel to their places (travel: 1 = at the shape, 0 = in the layout).
 */
export function foldSteps(fold) {
  const opened = 1 - fold;
  const ease = (t) => {
    const x = Math.min(1, Math.max(0, t));
    return x * x * (3 - 2 * x);
  };
  const travel = 1 - ease((opened - 0.45) / 0.55);
  return { push: ease(opened / 0.35) * travel, bend: 1 - ease((opened - 0.15) / 0.5), travel };
}

/**
 * Writes the part's positions into `out`, bent and moved as `steps` says (see foldSteps).
 * @param frame where the flat part lies: {origin, x, y} so that flat (u, v) lands at origin + (u x + v y) / scale
 */
export function foldPart(part, prepared, position, flat, scale, { bend: share, travel }, frame, out) {
  if (share >= 1 && travel >= 1) {
    out.set(position.subarray(3 * part.begin, 3 * part.end), 3 * part.begin);
    return;
  }
  const normals = new Float64Array(3 * prepared.count);
  placeRoot(part, prepared.root, position, flat, scale, travel, frame, out, normals);
  for (const hinge of prepared.steps) placeNext(hinge, scale, share, out, normals);
}

/** The first triangle moves rigidly from its place in the shape to its place in the flat layout. */
function placeRoot(part, root, position, flat, scale, travel, frame, out, normals) {
  const corners = [0, 1, 2].map((k) => part.triangles[3 * root + k]);
  const inShape = frameOf(corners.map((v) => [position[3 * v], position[3 * v + 1], position[3 * v + 2]]));
  const onSheet = frameOf(
    corners.map((v) =>
      [0, 1, 2].map(
        (axis) => frame.origin[axis] + (flat[2 * v] * frame.x[axis] + flat[2 * v + 1] * frame.y[axis]) / scale,
      ),
    ),
  );
  const turn = slerp(onSheet.turn, inShape.turn, travel);
  const center = onSheet.center.map((value, axis) => value + (inShape.center[axis] - value) * travel);
  // The corners in the triangle's own frame are the same in shape and sheet, because the part does not stretch.
  corners.forEach((v, k) => {
    const moved = rotate(turn, onSheet.local[k]);
    for (let axis = 0; axis < 3; axis++) out[3 * v + axis] = center[axis] + moved[axis];
  });
  const normal = rotate(turn, [0, 0, 1]);
  normals.set(normal, 3 * root);
}

function placeNext({ from, to, a, b, c, along, height, angle }, scale, share, out, normals) {
  const edge = unit(sub(out, b, a));
  const before = [normals[3 * from], normals[3 * from + 1], normals[3 * from + 2]];
  const away = cross(edge, before);
  const [sine, cosine] = [Math.sin(angle * share), Math.cos(angle * share)];
  const length = Math.hypot(...sub(out, b, a));
  for (let axis = 0; axis < 3; axis++) {
    const direction = cosine * away[axis] - sine * before[axis];
    out[3 * c + axis] = out[3 * a + axis] + edge[axis] * along * length + direction * (height / scale);
    normals[3 * to + axis] = cosine * before[axis] + sine * away[axis];
  }
}

/** A right-handed frame of a triangle: its centre, turn as a quaternion, and the corners in it. */
function frameOf(corners) {
  const center = [0, 1, 2].map((axis) => (corners[0][axis] + corners[1][axis] + corners[2][axis]) / 3);
  const x = unit(corners[1].map((value, axis) => value - corners[0][axis]));
  const z = unit(
    cross(
      x,
      corners[2].map((value, axis) => value - corners[0][axis]),
    ),
  );
  const y = cross(z, x);
  const local = corners.map((corner) => {
    const arm = corner.map((value, axis) => value - center[axis]);
    return [dot(arm, x), dot(arm, y), dot(arm, z)];
  });
  return { center, local, turn: quaternion(x, y, z) };
}

function quaternion(x, y, z) {
  const trace = x[0] + y[1] + z[2];
  if (trace > 0) {
    const w = Math.sqrt(1 + trace) * 2;
    return [(y[2] - z[1]) / w, (z[0] - x[2]) / w, (x[1] - y[0]) / w, w / 4];
  }
  if (x[0] > y[1] && x[0] > z[2]) {
    const w = Math.sqrt(1 + x[0] - y[1] - z[2]) * 2;
    return [w / 4, (y[0] + x[1]) / w, (z[0] + x[2]) / w, (y[2] - z[1]) / w];
  }
  if (y[1] > z[2]) {
    const w = Math.sqrt(1 + y[1] - x[0] - z[2]) * 2;
    return [(y[0] + x[1]) / w, w / 4, (z[1] + y[2]) / w, (z[0] - x[2]) / w];
  }
  const w = Math.sqrt(1 + z[2] - x[0] - y[1]) * 2;
  return [(z[0] + x[2]) / w, (z[1] + y[2]) / w, w / 4, (x[1] - y[0]) / w];
}

function slerp(p, q, t) {
  let cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3];
  const sign = cosine < 0 ? -1 : 1;
  cosine *= sign;
  const angle = Math.acos(Math.min(1, cosine));
  const [from, to] =
    angle < 1e-6 ? [1 - t, t] : [Math.sin((1 - t) * angle) / Math.sin(angle), Math.sin(t * angle) / Math.sin(angle)];
  const mixed = p.map((value, k) => from * value + to * sign * q[k]);
  const size = Math.hypot(...mixed);
  return mixed.map((value) => value / size);
}

function rotate([x, y, z, w], v) {
  const t = cross([x, y, z], v).map((value) => 2 * value);
  const u = cross([x, y, z], t);
  return v.map((value, axis) => value + w * t[axis] + u[axis]);
}
