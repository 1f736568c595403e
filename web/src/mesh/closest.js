// Distance from points to a triangle mesh: a bounding-box tree over the triangles, searched nearest box first.

const LEAF = 8;

/** @param {Float64Array|Float32Array} points @param {Uint32Array} faces */
export class ClosestPoints {
  constructor(points, faces) {
    this.points = points;
    this.faces = faces;
    const count = faces.length / 3;
    this.order = Uint32Array.from({ length: count }, (_, k) => k);
    this.centers = new Float64Array(3 * count);
    for (let f = 0; f < count; f++) {
      for (let axis = 0; axis < 3; axis++) {
        this.centers[3 * f + axis] =
          (points[3 * faces[3 * f] + axis] +
            points[3 * faces[3 * f + 1] + axis] +
            points[3 * faces[3 * f + 2] + axis]) /
          3;
      }
    }
    this.boxes = [];
    this.nodes = []; // [begin, end] of a leaf, or [-left, right]
    if (count > 0) this.build(0, count);
  }

  build(begin, end) {
    const node = this.nodes.length;
    this.nodes.push(null);
    const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    const middle = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
    for (let k = begin; k < end; k++) {
      const f = this.order[k];
      for (let corner = 0; corner < 3; corner++) widen(box, this.points, 3 * this.faces[3 * f + corner]);
      widen(middle, this.centers, 3 * f);
    }
    this.boxes.push(box);
    if (end - begin <= LEAF) {
      this.nodes[node] = [begin, end];
      return node;
    }
    const extents = [0, 1, 2].map((a) => middle[a + 3] - middle[a]);
    const axis = extents.indexOf(Math.max(...extents));
    const half = (begin + end) >> 1;
    const part = this.order.subarray(begin, end);
    part.set(Array.from(part).sort((a, b) => this.centers[3 * a + axis] - this.centers[3 * b + axis]));
    const left = this.build(begin, half);
    const right = this.build(half, end);
    this.nodes[node] = [-left, right];
    return node;
  }

  /** Distance of (x, y, z) to the mesh; this.nearest is then the face it was measured to. */
  distance(x, y, z) {
    let best = Infinity;
    const stack = [0];
    while (stack.length > 0) {
      const node = stack.pop();
      if (boxDistance(this.boxes[node], x, y, z) >= best) continue;
      const [a, b] = this.nodes[node];
      if (a < 0) {
        const first = boxDistance(this.boxes[-a], x, y, z) < boxDistance(this.boxes[b], x, y, z);
        stack.push(first ? b : -a, first ? -a : b);
        continue;
      }
      for (let k = a; k < b; k++) {
        const squared = this.triangle(this.order[k], x, y, z);
        if (squared < best) {
          best = squared;
          this.nearest = this.order[k];
        }
      }
    }
    return Math.sqrt(best);
  }

  nearest = -1;

  /** Squared distance to one triangle by the regions of its plane (Ericson, Real-Time Collision Detection, 5.1.5). */
  triangle(f, x, y, z) {
    const p = this.points;
    const [i, j, k] = [3 * this.faces[3 * f], 3 * this.faces[3 * f + 1], 3 * this.faces[3 * f + 2]];
    const [ax, ay, az] = [p[i], p[i + 1], p[i + 2]];
    const [ux, uy, uz] = [p[j] - ax, p[j + 1] - ay, p[j + 2] - az];
    const [vx, vy, vz] = [p[k] - ax, p[k + 1] - ay, p[k + 2] - az];
    const [wx, wy, wz] = [x - ax, y - ay, z - az];
    const d1 = ux * wx + uy * wy + uz * wz;
    const d2 = vx * wx + vy * wy + vz * wz;
    const uu = ux * ux + uy * uy + uz * uz;
    const uv = ux * vx + uy * vy + uz * vz;
    const vv = vx * vx + vy * vy + vz * vz;
    const [d3, d4, d5, d6] = [d1 - uu, d2 - uv, d1 - uv, d2 - vv];
    const va = d3 * d6 - d5 * d4;
    const vb = d5 * d2 - d1 * d6;
    const vc = d1 * d4 - d3 * d2;
    let s = 0;
    let t = 0;
    if (d1 <= 0 && d2 <= 0) [s, t] = [0, 0];
    else if (d3 >= 0 && d4 <= d3) [s, t] = [1, 0];
    else if (vc <= 0 && d1 >= 0 && d3 <= 0) [s, t] = [d1 / (d1 - d3), 0];
    else if (d6 >= 0 && d5 <= d6) [s, t] = [0, 1];
    else if (vb <= 0 && d2 >= 0 && d6 <= 0) [s, t] = [0, d2 / (d2 - d6)];
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
      t = (d4 - d3) / (d4 - d3 + d5 - d6);
      s = 1 - t;
    } else [s, t] = [vb / (va + vb + vc), vc / (va + vb + vc)];
    return (x - ax - s * ux - t * vx) ** 2 + (y - ay - s * uy - t * vy) ** 2 + (z - az - s * uz - t * vz) ** 2;
  }
}

function widen(box, values, at) {
  for (let axis = 0; axis < 3; axis++) {
    const value = values[at + axis];
    if (value < box[axis]) box[axis] = value;
    if (value > box[axis + 3]) box[axis + 3] = value;
  }
}

function boxDistance(box, x, y, z) {
  const dx = Math.max(box[0] - x, 0, x - box[3]);
  const dy = Math.max(box[1] - y, 0, y - box[4]);
  const dz = Math.max(box[2] - z, 0, z - box[5]);
  return dx * dx + dy * dy + dz * dz;
}
