// Built-in shapes, made by formula: something to try without a file at hand. Lengths in millimetres, z is up.

const TAU = 2 * Math.PI;

/** A grid over [0, 1]², mapped by at(u, v) to [x, y, z]; `around` glues u = 1 to u = 0, `ring` does so for v. */
function grid(nu, nv, at, { around = true, ring = false } = {}) {
  const columns = around ? nu : nu + 1;
  const rows = ring ? nv : nv + 1;
  const points = [];
  const faces = [];
  for (let j = 0; j < rows; j++) {
    for (let i = 0; i < columns; i++) points.push(at(i / nu, j / nv));
  }
  const id = (i, j) => (j % rows) * columns + (i % columns);
  for (let j = 0; j < nv; j++) {
    for (let i = 0; i < nu; i++) {
      const [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
      // Alternating diagonals keep the grid free of a direction of its own.
      faces.push(
        ...((i + j) % 2
          ? [
              [a, b, c],
              [a, c, d],
            ]
          : [
              [a, b, d],
              [b, c, d],
            ]),
      );
    }
  }
  return { points, faces };
}

function turned(radius, height, { nu = 72, nv = 44 } = {}) {
  return grid(nu, nv, (u, v) => {
    const [r, z] = [radius(v, u), height * v];
    return [r * Math.cos(TAU * u), r * Math.sin(TAU * u), z];
  });
}

export const SAMPLES = [
  {
    id: "lampshade",
    title: "Lampshade",
    text: "flared, open at both ends",
    make: () => turned((v) => 62 + 74 * (1 - v) ** 2 - 10 * v * v, 190),
  },
  {
    id: "vase",
    title: "Wavy vase",
    text: "five soft waves around",
    make: () =>
      turned(
        (v, u) => 44 + 20 * Math.sin(TAU * v * 0.72 + 0.5) + 4 * Math.cos(5 * TAU * u) * Math.sin(Math.PI * v),
        210,
        { nu: 100, nv: 52 },
      ),
  },
  {
    id: "tower",
    title: "Cooling tower",
    text: "curved both ways",
    make: () => turned((v) => 55 * Math.sqrt(1 + ((v - 0.62) / 0.5) ** 2), 220),
  },
  {
    id: "dome",
    title: "Dome",
    text: "half a ball",
    make: () =>
      grid(72, 22, (u, v) => {
        // A small hole at the top instead of a pole: every triangle keeps a good shape.
        const angle = ((0.04 + 0.96 * (1 - v)) * Math.PI) / 2;
        return [
          120 * Math.sin(angle) * Math.cos(TAU * u),
          120 * Math.sin(angle) * Math.sin(TAU * u),
          120 * Math.cos(angle),
        ];
      }),
  },
  {
    id: "ring",
    title: "Ring",
    text: "a torus, closed",
    make: () =>
      grid(
        84,
        36,
        (u, v) => {
          const r = 90 + 36 * Math.cos(TAU * v);
          return [r * Math.cos(TAU * u), r * Math.sin(TAU * u), 36 * Math.sin(TAU * v)];
        },
        { ring: true },
      ),
  },
  {
    id: "sail",
    title: "Sail roof",
    text: "four corners, two of them high",
    make: () =>
      grid(
        46,
        46,
        (u, v) => {
          const [x, y] = [2 * u - 1, 2 * v - 1];
          return [300 * x * (1 - 0.12 * (1 - y * y)), 300 * y * (1 - 0.12 * (1 - x * x)), 70 * (x * x - y * y) + 80];
        },
        { around: false },
      ),
  },
];

/** The sample as an OBJ file. */
export function sampleFile(sample) {
  const { points, faces } = sample.make();
  const lines = [`# sheetform sample: ${sample.title}`, `o ${sample.id}`];
  for (const p of points) lines.push(`v ${p.map((x) => x.toFixed(5)).join(" ")}`);
  for (const f of faces) lines.push(`f ${f.map((k) => k + 1).join(" ")}`);
  return new File([lines.join("\n") + "\n"], `${sample.id}.obj`, { type: "model/obj" });
}
