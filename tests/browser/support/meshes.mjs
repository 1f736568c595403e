// Mesh files for the tests of the page, as what setInputFiles takes: {name, mimeType, buffer}.

const file = (name, text) => ({ name, mimeType: "application/octet-stream", buffer: Buffer.from(text) });

/** A tube open at both ends as binary STL: radius and height in the file's unit. */
export function tubeStl(name = "tube.stl", { radius = 2, height = 5, around = 48, up = 24 } = {}) {
  const at = (i, j) => [
    radius * Math.cos((2 * Math.PI * (i % around)) / around),
    radius * Math.sin((2 * Math.PI * (i % around)) / around),
    (height * j) / up,
  ];
  const faces = [];
  for (let i = 0; i < around; i++) {
    for (let j = 0; j < up; j++) {
      const [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
      faces.push([a, b, c], [a, c, d]);
    }
  }
  const buffer = Buffer.alloc(84 + 50 * faces.length);
  buffer.writeUInt32LE(faces.length, 80);
  faces.forEach((face, f) => face.flat().forEach((value, k) => buffer.writeFloatLE(value, 84 + 50 * f + 12 + 4 * k)));
  return { name, mimeType: "model/stl", buffer };
}

/** The tube, whose copy broke off: the last quarter of its triangles is missing. */
export function cutShort(name = "cut-short.stl") {
  const { buffer, ...rest } = tubeStl(name, { radius: 40, height: 100 });
  return { ...rest, buffer: buffer.subarray(0, Math.floor(0.75 * buffer.length)) };
}

export const letter = () => file("letter.obj", "Dear reader,\nthis is not a mesh.\n");

/** Readable, but without any area: nothing can be made of it. */
export const flatLine = () => file("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3\nf 2 3 4\n");

/** A sheet with a fin that stands on its middle: eight edges have three faces. */
export function finned(name = "fin.obj") {
  const lines = [];
  const n = 8;
  for (let j = 0; j <= n; j++) for (let i = 0; i <= n; i++) lines.push(`v ${10 * i} ${10 * j} ${4 * Math.sin(i / 3)}`);
  for (let j = 0; j <= n; j++) lines.push(`v 40 ${10 * j} 40`);
  const [at, up] = [(i, j) => j * (n + 1) + i + 1, (j) => (n + 1) ** 2 + j + 1];
  for (let j = 0; j < n; j++) {
    for (let i = 0; i < n; i++) lines.push(`f ${at(i, j)} ${at(i + 1, j)} ${at(i + 1, j + 1)} ${at(i, j + 1)}`);
    lines.push(`f ${at(4, j)} ${at(4, j + 1)} ${up(j + 1)} ${up(j)}`);
  }
  return file(name, lines.join("\n"));
}

/** A dense wavy ball: work for some seconds. Another `wave` is another mesh (the server knows results it has made). */
export function ball(name = "ball.obj", { around = 200, up = 100, wave = 0.12 } = {}) {
  const lines = [];
  for (let j = 1; j < up; j++) {
    for (let i = 0; i < around; i++) {
      const [a, b] = [(2 * Math.PI * i) / around, (Math.PI * j) / up];
      const r = 80 * (1 + wave * Math.sin(3 * a) * Math.sin(b) ** 3 + 0.1 * Math.cos(4 * b));
      lines.push(`v ${r * Math.sin(b) * Math.cos(a)} ${r * Math.sin(b) * Math.sin(a)} ${r * Math.cos(b)}`);
    }
  }
  const top = around * (up - 1) + 1;
  lines.push("v 0 0 88", "v 0 0 -88");
  const id = (i, j) => (j - 1) * around + (i % around) + 1;
  for (let i = 0; i < around; i++) {
    lines.push(`f ${top} ${id(i, 1)} ${id(i + 1, 1)}`, `f ${top + 1} ${id(i + 1, up - 1)} ${id(i, up - 1)}`);
    for (let j = 1; j < up - 1; j++)
      lines.push(
        `f ${id(i, j)} ${id(i, j + 1)} ${id(i + 1, j + 1)}`,
        `f ${id(i, j)} ${id(i + 1, j + 1)} ${id(i + 1, j)}`,
      );
  }
  return file(name, lines.join("\n"));
}

/** A strip of a cylinder, decomposed in no time; each `seed` is another mesh. */
export function strip(name = "strip.obj", seed = 0) {
  const lines = [];
  const [along, length] = [12, 60 + seed / 8];
  for (let i = 0; i <= along; i++) {
    const angle = (1.8 * i) / along;
    for (const y of [0, length]) lines.push(`v ${40 * Math.cos(angle)} ${y} ${40 * Math.sin(angle)}`);
  }
  for (let i = 0; i < along; i++) {
    const a = 2 * i + 1;
    lines.push(`f ${a} ${a + 1} ${a + 3}`, `f ${a} ${a + 3} ${a + 2}`);
  }
  return file(name, lines.join("\n"));
}
