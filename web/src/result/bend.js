// How tightly sheets bend, against what a material can do.
import { bend } from "./fold.js";

const EASY = [0.62, 0.78, 0.62];
const NEAR = [0.93, 0.75, 0.36];
const OVER = [0.83, 0.36, 0.3];

/**
 * The bend radius around each hinge of a part, in mm: the turning is summed over neighbouring hinges until they span
 * `reach` mm of sheet, because a single narrow triangle says nothing. Signed, so that zigzag of diagonals cancels.
 * Infinity where nothing bends. A sharp fold counts as a bend of its angle over the reach.
 */
export function bendRadii(part, position, flat, reach) {
  const hinges = part.inner.map(([first, second]) => ({
    angle: bend(position, first[0], first[1], first[2], second[2]),
    sides: [
      { triangle: first[3], width: height(first, flat) },
      { triangle: second[3], width: height(second, flat) },
    ],
  }));
  const around = new Map();
  hinges.forEach((hinge, k) =>
    hinge.sides.forEach(({ triangle }) => around.set(triangle, [...(around.get(triangle) ?? []), k])),
  );
  return hinges.map((hinge, k) => {
    const [left, right] = hinge.sides.map((side) => walk(hinges, around, k, side, reach / 2));
    const angle = Math.abs(hinge.angle + left.angle + right.angle);
    return angle < 1e-6 ? Infinity : Math.max(left.width + right.width, reach) / angle;
  });
}

/**
 * Goes from hinge to hinge through triangles that have just one more, until `reach` mm are spanned. From a hinge to the
 * next is half a triangle's height on average; half of that way belongs to each of the two.
 */
function walk(hinges, around, from, side, reach) {
  let [angle, at, { triangle, width: across }] = [0, from, side];
  let width = across / 4;
  for (let steps = 0; steps < 400 && width < reach; steps++) {
    const next = around.get(triangle).filter((k) => k !== at);
    if (next.length !== 1) break;
    [at] = next;
    const hinge = hinges[at];
    const beyond = hinge.sides[hinge.sides[0].triangle === triangle ? 1 : 0];
    angle += hinge.angle;
    width += (across + beyond.width) / 4;
    ({ triangle, width: across } = beyond);
  }
  return { width, angle };
}

/** Width of a triangle across the hinge: the distance of its third corner, in mm. */
function height([a, b, c], flat) {
  const [ex, ey] = [flat[2 * b] - flat[2 * a], flat[2 * b + 1] - flat[2 * a + 1]];
  const [cx, cy] = [flat[2 * c] - flat[2 * a], flat[2 * c + 1] - flat[2 * a + 1]];
  return Math.abs(cx * ey - cy * ex) / (Math.hypot(ex, ey) || 1);
}

/** Colours per vertex (sRGB) for a material, the tightest radius, the share that bends easily, what to make of it. */
export function bendColors(model, material) {
  const radius = new Float64Array(model.source.length).fill(Infinity);
  let tightest = Infinity;
  let [area, tight] = [0, 0];
  for (const part of model.parts) {
    const radii = bendRadii(part, model.position, model.flat, material.radius / 2);
    const areas = hingeAreas(part, model.flat);
    area += part.area;
    radii.forEach((r, k) => {
      tightest = Math.min(tightest, r);
      if (r < material.radius) tight += areas[k];
      for (const v of part.inner[k][0].slice(0, 2)) radius[v] = Math.min(radius[v], r);
    });
  }
  const values = new Float32Array(3 * radius.length);
  radius.forEach((r, v) =>
    values.set(
      r < material.radius ? OVER : r < 2 * material.radius ? mix(NEAR, EASY, r / material.radius - 1) : EASY,
      3 * v,
    ),
  );
  return { values, tightest, easy: area > 0 ? 1 - tight / area : 1, text: verdict(tightest, material) };
}

/** Area of sheet that belongs to each hinge of a part, mm²: a triangle is shared by the hinges that it has. */
function hingeAreas(part, flat) {
  const hinges = new Map();
  for (const pair of part.inner) for (const side of pair) hinges.set(side[3], (hinges.get(side[3]) ?? 0) + 1);
  const share = ([a, b, c, triangle]) => areaOf(a, b, c, flat) / hinges.get(triangle);
  return part.inner.map(([first, second]) => share(first) + share(second));
}

function areaOf(a, b, c, flat) {
  const [ex, ey] = [flat[2 * b] - flat[2 * a], flat[2 * b + 1] - flat[2 * a + 1]];
  const [cx, cy] = [flat[2 * c] - flat[2 * a], flat[2 * c + 1] - flat[2 * a + 1]];
  return Math.abs(cx * ey - cy * ex) / 2;
}

function verdict(tightest, { title, radius }) {
  if (tightest >= radius) return `${title} can do that.`;
  const factor = radius / tightest;
  const larger = factor < 10 ? ` or make it ${factor.toFixed(1)} times larger` : "";
  return `${title} of this thickness wants ${radius} mm: score the red lines, take thinner stock${larger}.`;
}

const mix = (a, b, t) => a.map((value, k) => value + (b[k] - value) * Math.min(1, Math.max(0, t)));
