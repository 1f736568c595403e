// Where the numbers of a part's seams stand: in the middle of each run along its outline.

/**
 * @param part with outline (vertices), outlineSeams (the seam from each vertex to the next, below 0: none), and tips
 *   (vertices at which a seam ends inside the part: its other side follows; may be left out)
 * @param points coordinates of all vertices, `size` for each
 * @returns [{seam, at, vertex}], one for every run of edges of the same seam (a seam of the part with itself has two);
 *   vertex = the outline's vertex before the place
 */
export function seamPlaces({ outline, outlineSeams, tips = [] }, points, size) {
  const n = outline.length;
  const seams = Array.from(outlineSeams);
  const begins = (k) => seams[k % n] !== seams[(k + n - 1) % n] || tips.includes(outline[k % n]);
  // Begins where a run does, so that none is cut in two.
  const first = Math.max(
    0,
    seams.findIndex((_, k) => begins(k)),
  );
  const places = [];
  for (let k = 0; k < n; ) {
    const seam = seams[(first + k) % n];
    let end = k + 1;
    while (end < n && !begins(first + end)) end++;
    const vertices = Array.from({ length: end - k + 1 }, (_, step) => outline[(first + k + step) % n]);
    const middle = middleOf(vertices.map((v) => pointOf(points, v, size)));
    if (seam >= 0) places.push({ seam, at: middle.at, vertex: vertices[middle.after] });
    k = end;
  }
  return places;
}

const pointOf = (points, v, size) => Array.from({ length: size }, (_, axis) => points[size * v + axis]);
const distance = (a, b) => Math.hypot(...a.map((value, axis) => b[axis] - value));

/** The point half way along a polyline, and the place in the list of the point before it. */
function middleOf(run) {
  const lengths = run.slice(1).map((point, k) => distance(run[k], point));
  let left = lengths.reduce((sum, length) => sum + length, 0) / 2;
  for (let k = 0; k < lengths.length; k++) {
    if (left <= lengths[k]) {
      const share = lengths[k] > 0 ? left / lengths[k] : 0;
      return { at: run[k].map((value, axis) => value + share * (run[k + 1][axis] - value)), after: k };
    }
    left -= lengths[k];
  }
  return { at: run.at(-1), after: run.length - 1 };
}
