// How tightly sheets bend, against what a material can do.
import { bend } from "./fold.js";

const EASY = [0.62, 0.78, 0.62];
const NEAR = [0.93, 0.75, 0.36];
const OVER = [0.83, 0.36, 0.3];

/**
 * The local bend radius at a hinge between two triangles: their mean width across the hinge over the angle between them
 * (a polygon of such steps with the same curvature). Infinity where nothing bends.
 */
export function hingeRadius(part, [first, second], position, flat) {
  const angle = Math.abs(bend(position, first[0], first[1], first[2], second[2]));
  if (angle < 1e-6) return Infinity;
  const width = (height(first, flat) + height(second, flat)) / 2;
  return width / 2 / Math.tan(angle / 2);
}

/** Width of a triangle across the hinge: the distance of its third corner, in mm. */
function height([a, b, c], flat) {
  const [ex, ey] = [flat[2 * b] - flat[2 * a], flat[2 * b + 1] - flat[2 * a + 1]];
  const [cx, cy] = [flat[2 * c] - flat[2 * a], flat[2 * c + 1] - flat[2 * a + 1]];
  return Math.abs(cx * ey - cy * ex) / (Math.hypot(ex, ey) || 1);
}

/** Tightest radius of each part in mm. Single sharp hinges count as bends, too. */
export function tightestRadii(model) {
  return model.parts.map((part) => {
    let least = Infinity;
    for (const edge of part.inner) least = Math.min(least, hingeRadius(part, edge, model.position, model.flat));
    return least;
  });
}

/** Colours per vertex (sRGB) for a material, the tightest radius, and what to make of it. */
export function bendColors(model, material) {
  const radius = new Float64Array(model.source.length).fill(Infinity);
  let tightest = Infinity;
  for (const part of model.parts) {
    for (const edge of part.inner) {
      const r = hingeRadius(part, edge, model.position, model.flat);
      tightest = Math.min(tightest, r);
      for (const v of [edge[0][0], edge[0][1]]) radius[v] = Math.min(radius[v], r);
    }
  }
  const values = new Float32Array(3 * radius.length);
  radius.forEach((r, v) => values.set(r < material.radius ? OVER : r < 2 * material.radius ? mix(NEAR, EASY, r / material.radius - 1) : EASY, 3 * v));
  const factor = material.radius / tightest;
  const text = tightest >= material.radius ? `${material.title} can do that.`
    : `${material.title} of this thickness wants ${material.radius} mm: score these lines, take thinner stock, or make it ${factor.toFixed(1)} times larger.`;
  return { values, tightest, text };
}

const mix = (a, b, t) => a.map((value, k) => value + (b[k] - value) * Math.min(1, Math.max(0, t)));
