// A result by formula, for tests of the page: a surface of revolution made of flat-sided gores, each gore cut in two.
// Every gore is a chain of planar trapezoids, so its unfolding is known in closed form.

/** @returns {{obj: string, layout: object}} the two files of a result; lengths of the mesh times `scale` are mm */
export function gores({
  count = 8,
  rows = 12,
  height = 200,
  radius = (t) => 50 + 20 * Math.sin(5 * t),
  scale = 1,
} = {}) {
  const points = [];
  for (let i = 0; i < count; i++) {
    for (let k = 0; k <= rows; k++) {
      const [angle, r] = [(2 * Math.PI * i) / count, radius(k / rows)];
      points.push([r * Math.cos(angle), r * Math.sin(angle), (height * k) / rows]);
    }
  }
  const id = (i, k) => (i % count) * (rows + 1) + k;
  const length = (a, b) => Math.hypot(...points[a].map((value, axis) => value - points[b][axis]));
  const file = { uvs: [], lines: [], patches: [], arches: new Map() };
  for (let i = 0; i < count; i++) {
    for (const half of [0, 1])
      addGore(file, { i, from: (half * rows) / 2, to: ((half + 1) * rows) / 2, half, id, length, scale, rows, count });
  }
  const number = (value) => value.toPrecision(17);
  const text = [
    ...points.map((p) => `v ${p.map(number).join(" ")}`),
    ...file.uvs.map((uv) => `vt ${uv.map(number).join(" ")}`),
    ...file.lines,
  ];
  const diagonal = Math.hypot(2 * 70, 2 * 70, height);
  return {
    obj: `${text.join("\n")}\n`,
    layout: {
      schema: "sheetform-layout/1",
      scale,
      input: { vertices: points.length, faces: 2 * count * rows, bbox_diagonal: diagonal },
      parameters: { e_max: 0.02 },
      patches: file.patches,
      arches: [...file.arches.values()],
      report: {
        patches: file.patches.length,
        hausdorff: 0.01,
        hausdorff_at_most: 0.0102,
        mean_distance: 0.003,
        e_max_met: true,
        isometry_error: 0,
        timings: {},
      },
    },
  };
}

function addGore(file, { i, from, to, half, id, length, scale, rows, count }) {
  const patch = file.patches.length;
  const base = file.uvs.length;
  let up = 0;
  for (let k = from; k <= to; k++) {
    const width = length(id(i, k), id(i + 1, k));
    if (k > from) {
      const side = length(id(i, k), id(i, k - 1));
      up += Math.sqrt(side ** 2 - ((width - length(id(i, k - 1), id(i + 1, k - 1))) / 2) ** 2);
    }
    const [x, y] = [80 * i, half * height(rows) + up];
    file.uvs.push([(x - width / 2) * scale, y * scale], [(x + width / 2) * scale, y * scale]);
  }
  file.lines.push(`g patch_${patch}`);
  const rulings = [];
  for (let k = from; k < to; k++) {
    const t = base + 2 * (k - from) + 1;
    const [a, b, c, d] = [id(i, k), id(i + 1, k), id(i + 1, k + 1), id(i, k + 1)].map((v) => v + 1);
    file.lines.push(`f ${a}/${t} ${b}/${t + 1} ${c}/${t + 3}`, `f ${a}/${t} ${c}/${t + 3} ${d}/${t + 2}`);
    if (k > from) rulings.push([a - 1, b - 1]);
  }
  const side = (column) => Array.from({ length: to - from + 1 }, (_, k) => id(column, from + k));
  const [left, right] = [side(i), side(i + 1)];
  const n = right.length;
  const arches = [
    archOf(file, `side ${(i + 1) % count} ${half}`, right, patch),
    archOf(file, `top ${i} ${to}`, [id(i + 1, to), id(i, to)], patch),
    archOf(file, `side ${i} ${half}`, left, patch),
    archOf(file, `top ${i} ${from}`, [id(i, from), id(i + 1, from)], patch),
  ];
  file.patches.push({
    id: patch,
    label: `${String.fromCharCode(65 + i)}${half + 1}`,
    boundary: [...right, ...left.reverse()],
    corners: [0, n - 1, n, 2 * n - 1],
    arches,
    rulings,
    sheet: 0,
    mirror_of: null,
  });
}

const height = (rows) => 20 * rows;

function archOf(file, key, vertices, patch) {
  const known = file.arches.get(key);
  if (known) known.patches[1] = patch;
  else file.arches.set(key, { id: file.arches.size, vertices, patches: [patch, null] });
  return file.arches.get(key).id;
}
