// The picture of the first page: a lampshade of five gores, and the same gores flat. Drawn by formula, to scale.
import { s } from "../dom.js";

const GORES = 10;
const ROWS = 26;
const radius = (t) => 34 + 40 * (1 - t) ** 2 - 5 * t * t;

/** A point of the lamp seen a little from above. */
function seen(t, angle) {
  const r = radius(t);
  return [r * Math.cos(angle), 118 * (1 - t) + r * 0.26 * Math.sin(angle)];
}

/** Half width of one flat gore at height t, and how far up it lies (the arc length of the profile). */
function flat(t) {
  let length = 0;
  const steps = 40;
  for (let k = 0; k < steps; k++) {
    const [a, b] = [(t * k) / steps, (t * (k + 1)) / steps];
    length += Math.hypot(118 * (b - a), radius(b) - radius(a));
  }
  return [radius(t) * Math.tan(Math.PI / GORES), -length];
}

const path = (points) => `M${points.map(([x, y]) => `${x.toFixed(1)} ${y.toFixed(1)}`).join("L")}`;

export function illustration() {
  const rows = Array.from({ length: ROWS + 1 }, (_, k) => k / ROWS);
  const lamp = s("g", { transform: "translate(120 36)" });
  // From back to front; of those behind one sees the inside.
  const angle = (k) => (2 * Math.PI * k) / GORES;
  const order = Array.from({ length: GORES }, (_, k) => k).sort(
    (a, b) => Math.sin(angle(a + 0.5)) - Math.sin(angle(b + 0.5)),
  );
  for (const k of order) {
    const side = (at) => rows.map((t) => seen(t, at));
    const inside = Math.sin(angle(k + 0.5)) < 0;
    lamp.append(
      s("path", {
        class: inside ? "sheet inside" : `sheet color-${k}`,
        d: `${path([...side(angle(k)), ...side(angle(k + 1)).reverse()])}Z`,
      }),
    );
    if (inside) continue;
    for (let r = 3; r < ROWS; r += 3)
      lamp.append(s("path", { class: "ruling", d: path([seen(rows[r], angle(k)), seen(rows[r], angle(k + 1))]) }));
  }
  const sheets = s("g", {});
  for (let k = 0; k < GORES / 2; k++) {
    const left = rows.map((t) => {
      const [w, y] = flat(t);
      return [-w, y];
    });
    const right = rows.map((t) => flat(t)).reverse();
    const group = s(
      "g",
      { transform: `translate(${302 + 56 * k} 182)` },
      s("path", { class: `sheet color-${k}`, d: `${path([...left, ...right])}Z` }),
    );
    for (let r = 3; r < ROWS; r += 3) {
      const [w, y] = flat(rows[r]);
      group.append(
        s("path", {
          class: "ruling",
          d: path([
            [-w, y],
            [w, y],
          ]),
        }),
      );
    }
    sheets.append(group);
  }
  const arrow = s("path", { class: "arrow", d: "M216 108h42m0 0-9-8m9 8-9 8" });
  return s(
    "svg",
    {
      class: "illustration",
      viewBox: "30 10 540 190",
      role: "img",
      "aria-label": "A lampshade, and the flat parts it is made of",
    },
    lamp,
    arrow,
    sheets,
  );
}
