// Where a part's label has most room: the point inside the outline farthest from it, by refining a coarse grid.

/** @returns {{x, y, room}} room = distance to the outline */
export function labelPlace(outline, flat) {
  const ring = Array.from(outline, (v) => [flat[2 * v], flat[2 * v + 1]]);
  const xs = ring.map((p) => p[0]);
  const ys = ring.map((p) => p[1]);
  const box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
  let best = { x: (box[0] + box[2]) / 2, y: (box[1] + box[3]) / 2, room: -Infinity };
  let [cx, cy, w, d] = [best.x, best.y, box[2] - box[0], box[3] - box[1]];
  for (let round = 0; round < 4; round++) {
    const n = round === 0 ? 14 : 6;
    for (let i = 0; i <= n; i++) {
      for (let j = 0; j <= n; j++) {
        const [x, y] = [cx + w * (i / n - 0.5), cy + d * (j / n - 0.5)];
        const room = signedDistance(ring, x, y);
        if (room > best.room) best = { x, y, room };
      }
    }
    [cx, cy, w, d] = [best.x, best.y, (2.2 * w) / n, (2.2 * d) / n];
  }
  return { ...best, room: Math.max(best.room, 0) };
}

/** Distance to the ring, positive inside. */
function signedDistance(ring, x, y) {
  let inside = false;
  let best = Infinity;
  for (let k = 0, j = ring.length - 1; k < ring.length; j = k++) {
    const [ax, ay] = ring[j];
    const [bx, by] = ring[k];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
    const [ex, ey] = [bx - ax, by - ay];
    const t = Math.min(1, Math.max(0, ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey || 1)));
    best = Math.min(best, (x - ax - t * ex) ** 2 + (y - ay - t * ey) ** 2);
  }
  return (inside ? 1 : -1) * Math.sqrt(best);
}
