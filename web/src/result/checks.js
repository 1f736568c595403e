// Promises of a result that its files alone can show, measured independently of the program that made them.

/** Largest difference between an edge in space and on the sheet, in mm and as a share of its part's size. */
export function measureStretch({ parts, position, flat, scale }) {
  let [absolute, share] = [0, 0];
  for (const part of parts) {
    const size = Math.hypot(part.box[2] - part.box[0], part.box[3] - part.box[1]) || 1;
    for (let k = 0; k < part.triangles.length; k++) {
      const [a, b] = [part.triangles[k], part.triangles[k % 3 === 2 ? k - 2 : k + 1]];
      const solid =
        Math.hypot(
          position[3 * a] - position[3 * b],
          position[3 * a + 1] - position[3 * b + 1],
          position[3 * a + 2] - position[3 * b + 2],
        ) * scale;
      const difference = Math.abs(solid - Math.hypot(flat[2 * a] - flat[2 * b], flat[2 * a + 1] - flat[2 * b + 1]));
      absolute = Math.max(absolute, difference);
      share = Math.max(share, difference / size);
    }
  }
  return { absolute, share };
}

/** Vertices of sheets that are not on their outline. */
export function countInner({ parts }) {
  return parts.reduce((sum, part) => sum + (part.end - part.begin) - new Set(part.outline).size, 0);
}

/** Largest difference in length between the two sides of a seam on the sheets, in mm. */
export function measureSeams({ parts, flat, seams }) {
  const sides = new Map(seams.map((seam) => [seam.id, []]));
  for (const part of parts) {
    const lengths = new Map();
    part.outline.forEach((v, k) => {
      const seam = part.outlineSeams[k];
      if (seam < 0) return;
      const w = part.outline[(k + 1) % part.outline.length];
      lengths.set(
        seam,
        (lengths.get(seam) ?? 0) + Math.hypot(flat[2 * v] - flat[2 * w], flat[2 * v + 1] - flat[2 * w + 1]),
      );
    });
    for (const [seam, length] of lengths) sides.get(seam).push(length);
  }
  let worst = 0;
  for (const seam of seams) {
    const [a, b] = sides.get(seam.id);
    if (seam.border) continue;
    // A part joined to itself shows both sides of the seam at once.
    if (seam.self) worst = Math.max(worst, Math.abs(a - 2 * seam.length));
    else worst = b === undefined ? Infinity : Math.max(worst, Math.abs(a - b));
  }
  return worst;
}

/** Labels of the parts whose outline crosses itself (a sweep over segments sorted by their left end). */
export function partsThatCross({ parts, flat }) {
  return parts.filter((part) => crosses(part.outline, flat)).map((part) => part.label);
}

function crosses(outline, flat) {
  const n = outline.length;
  const at = (k) => [flat[2 * outline[k % n]], flat[2 * outline[k % n] + 1]];
  const segments = Array.from({ length: n }, (_, k) => {
    const [a, b] = [at(k), at(k + 1)];
    return { k, a, b, left: Math.min(a[0], b[0]), right: Math.max(a[0], b[0]) };
  }).sort((s, t) => s.left - t.left);
  let active = [];
  for (const segment of segments) {
    active = active.filter((other) => other.right >= segment.left);
    for (const other of active) {
      const apart = Math.abs(other.k - segment.k);
      if (apart > 1 && apart < n - 1 && properlyCross(other, segment)) return true;
    }
    active.push(segment);
  }
  return false;
}

function properlyCross({ a, b }, { a: c, b: d }) {
  const side = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}
