// The page's own reading of meshes: every format gives the same surface, and what is no mesh is refused in words.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { ClosestPoints } from "../../../web/src/mesh/closest.js";
import { inspect } from "../../../web/src/mesh/inspect.js";
import { angleBetween, faceNormal, vertexNormals } from "../../../web/src/mesh/normals.js";
import { MeshError, readMesh } from "../../../web/src/mesh/read_mesh.js";
import { SAMPLES, sampleFile } from "../../../web/src/mesh/samples.js";

globalThis.File ??= (await import("node:buffer")).File; // not yet global in node 18

const CORNERS = [
  [0, 0, 0],
  [2, 0, 0],
  [0, 3, 0],
  [0, 0, 4],
];
const FACES = [
  [0, 2, 1],
  [0, 1, 3],
  [1, 2, 3],
  [2, 0, 3],
];
const bytes = (text) => new TextEncoder().encode(text).buffer;

const FILES = {
  obj: bytes(
    `# tetrahedron\no t\n${CORNERS.map((p) => `v ${p.join(" ")}`).join("\n")}\n${FACES.map((f) => `f ${f.map((k) => `${k + 1}//1`).join(" ")}`).join("\n")}\n`,
  ),
  off: bytes(
    `OFF\n# comment\n4 4 6\n${CORNERS.map((p) => p.join(" ")).join("\n")}\n${FACES.map((f) => `3 ${f.join(" ")}`).join("\n")}\n`,
  ),
  stl: bytes(
    `solid t\n${FACES.map((f) => `facet normal 0 0 0\nouter loop\n${f.map((k) => `vertex ${CORNERS[k].join(" ")}`).join("\n")}\nendloop\nendfacet`).join("\n")}\nendsolid t\n`,
  ),
  ply: bytes(
    `ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n${CORNERS.map((p) => p.join(" ")).join("\n")}\n${FACES.map((f) => `3 ${f.join(" ")}`).join("\n")}\n`,
  ),
};

function binaryStl() {
  const view = new DataView(new ArrayBuffer(84 + 50 * FACES.length));
  view.setUint32(80, FACES.length, true);
  FACES.forEach((face, f) =>
    face.forEach((v, corner) =>
      CORNERS[v].forEach((value, axis) => view.setFloat32(84 + 50 * f + 12 + 12 * corner + 4 * axis, value, true)),
    ),
  );
  return view.buffer;
}

function binaryPly(little) {
  const head = bytes(
    `ply\nformat binary_${little ? "little" : "big"}_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 4\nproperty list uchar uint vertex_indices\nend_header\n`,
  );
  const view = new DataView(new ArrayBuffer(4 * 24 + 4 * 13));
  CORNERS.forEach((p, v) => p.forEach((value, axis) => view.setFloat64(24 * v + 8 * axis, value, little)));
  FACES.forEach((face, f) => {
    view.setUint8(96 + 13 * f, 3);
    face.forEach((v, corner) => view.setUint32(97 + 13 * f + 4 * corner, v, little));
  });
  const out = new Uint8Array(head.byteLength + view.byteLength);
  out.set(new Uint8Array(head));
  out.set(new Uint8Array(view.buffer), head.byteLength);
  return out.buffer;
}

describe("reading a tetrahedron", () => {
  const all = { ...FILES, "binary stl": binaryStl(), "little ply": binaryPly(true), "big ply": binaryPly(false) };
  for (const [name, buffer] of Object.entries(all)) {
    it(name, () => {
      const mesh = readMesh(buffer);
      const seen = inspect(mesh.points, mesh.faces);
      assert.equal(seen.vertices, 4);
      assert.equal(seen.faces, 4);
      assert.equal(seen.borderEdges, 0);
      assert.equal(seen.pieces, 1);
      assert.deepEqual(seen.box, { min: [0, 0, 0], max: [2, 3, 4] });
    });
  }
});

describe("what is no mesh", () => {
  const cut = (buffer, length) => buffer.slice(0, length);
  const cases = {
    empty: [new ArrayBuffer(0), /empty/],
    text: [bytes("Dear reader, this is a letter."), /not a mesh/],
    "obj without faces": [bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\n"), /no faces/],
    "obj with a missing vertex": [bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), /only 3/],
    "obj with a word for a number": [bytes("v 0 zero 0\nf 1 1 1\n"), /not a number/],
    "cut binary stl": [cut(binaryStl(), 150), /./],
    "cut ply": [cut(binaryPly(true), 260), /cut short/],
    "ply without end of header": [bytes("ply\nformat ascii 1.0\n"), /header/],
    "off with too few lines": [bytes("OFF\n4 4 6\n0 0 0\n"), /cut short/],
  };
  for (const [name, [buffer, words]] of Object.entries(cases)) {
    it(name, () =>
      assert.throws(
        () => readMesh(buffer),
        (error) => error instanceof MeshError && words.test(error.message),
      ),
    );
  }
});

describe("a damaged file", () => {
  const withNan = () => {
    const view = new DataView(binaryStl());
    view.setFloat32(84 + 50 * 2 + 12, NaN, true); // the first corner of the third triangle
    return view.buffer;
  };
  const text = (name) => new TextDecoder().decode(FILES[name]);
  // what is left, and where it is damaged
  const cases = {
    "binary stl with a corner that has no place": [withNan(), 3, [CORNERS[2], CORNERS[3]], /no place/, /face 3/],
    "binary stl cut short": [binaryStl().slice(0, 84 + 50 * 3 + 20), 3, FACES[2].map((v) => CORNERS[v]), /of 4 triangles 3/, /^$/],
    "text stl cut short": [
      bytes(text("stl").slice(0, text("stl").lastIndexOf("vertex"))), 3, FACES[2].map((v) => CORNERS[v]), /cut short/, /^$/],
    "obj with a word for a number": [
      bytes(text("obj").replace("v 0 0 4", "v 0 zero 4")), 1,
      [[0, 0, 0], [2, 0, 0], [2, 0, 0], [0, 3, 0], [0, 3, 0], [0, 0, 0]], /“zero” is not a number/, /line 6/],
    "obj with a missing vertex": [bytes(`${text("obj")}f 1 2 9\n`), 4, [CORNERS[0], CORNERS[1]], /only 4/, /face 5/],
    "off with a missing vertex": [bytes(text("off").replace("3 2 0 3", "3 2 x 3")), 3, [CORNERS[2], CORNERS[3]], /./, /face 4/],
    "off cut short": [bytes(text("off").slice(0, -8)), 3, FACES[2].map((v) => CORNERS[v]), /cut short/, /^$/],
    "ply cut short": [binaryPly(true).slice(0, -5), 3, FACES[2].map((v) => CORNERS[v]), /cut short/, /^$/],
  };
  for (const [name, [buffer, faces, places, words, where]] of Object.entries(cases)) {
    it(name, () => {
      const error = errorOf(buffer);
      assert.match(error.message, words);
      assert.match(error.where, where);
      assert.ok(error.fix);
      assert.equal(error.rest.faces.length, 3 * faces);
      assert.deepEqual(error.places, places);
      const seen = inspect(error.rest.points, error.rest.faces);
      assert.ok(seen.positions.every(Number.isFinite));
    });
  }

  it("of which nothing is left has nothing to show", () => {
    assert.equal(errorOf(bytes("v 0 zero 0\nf 1 1 1\n")).rest, null);
  });

  it("is none where a binary STL has a few bytes more, as some programs write", () => {
    const longer = new Uint8Array(binaryStl().byteLength + 2);
    longer.set(new Uint8Array(binaryStl()));
    assert.equal(readMesh(longer.buffer).faces.length, 12);
  });
});

function errorOf(buffer) {
  try {
    readMesh(buffer);
  } catch (error) {
    assert.ok(error instanceof MeshError, error.stack);
    return error;
  }
  assert.fail("it was taken");
}

it("notices faces that look inwards", () => {
  const flipped = FACES.map(([a, b, c]) => [a, c, b]);
  const points = Float64Array.from(CORNERS.flat());
  assert.equal(inspect(points, Uint32Array.from(FACES.flat())).insideOut, false);
  assert.equal(inspect(points, Uint32Array.from(flipped.flat())).insideOut, true);
});

it("counts open edges, crowded edges and pieces", () => {
  const points = Float64Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 9, 9, 9, 10, 9, 9, 9, 10, 9]);
  const seen = inspect(points, Uint32Array.from([0, 1, 2, 1, 0, 3, 0, 1, 4, 5, 6, 7]));
  assert.equal(seen.crowdedEdges, 1);
  assert.equal(seen.borderEdges, 6 + 3);
  assert.equal(seen.pieces, 2);
});

describe("samples", () => {
  for (const sample of SAMPLES) {
    it(sample.title, async () => {
      const mesh = readMesh(await sampleFile(sample).arrayBuffer());
      const seen = inspect(mesh.points, mesh.faces);
      assert.equal(seen.crowdedEdges, 0);
      assert.equal(seen.pieces, 1);
      assert.equal(seen.borderEdges === 0, sample.id === "ring");
      assert.ok(seen.faces > 2000 && seen.faces < 20000, String(seen.faces));
      // Outward: the signed volume over the surface is positive (the roof looks up).
      assert.ok(outward(mesh) > 0);
    });
  }
});

/** Sum over faces of normal . (centre of the face - centre of the box), with z counted from below. */
function outward({ points, faces }) {
  let sum = 0;
  for (let k = 0; k < faces.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => points.subarray(3 * faces[k + i], 3 * faces[k + i] + 3));
    const u = [0, 1, 2].map((i) => b[i] - a[i]);
    const v = [0, 1, 2].map((i) => c[i] - a[i]);
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    sum += normal.reduce((total, value, i) => total + value * a[i], 0);
  }
  return sum;
}

describe("normals", () => {
  it("of a ball point away from its middle", () => {
    const points = Float64Array.from([1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1]);
    const faces = Uint32Array.from([0, 1, 2, 1, 3, 2, 3, 4, 2, 4, 0, 2, 1, 0, 5, 3, 1, 5, 4, 3, 5, 0, 4, 5]);
    const normals = vertexNormals(points, faces);
    for (let v = 0; v < 6; v++)
      assert.ok(angleBetween(normals.subarray(3 * v, 3 * v + 3), points.subarray(3 * v, 3 * v + 3)) < 1e-5);
    assert.ok(Math.abs(angleBetween(faceNormal(points, faces, 0), [1, 0, 0]) - 54.7356) < 1e-3);
  });
});

describe("closest points", () => {
  it("to a unit square by brute force", () => {
    const points = Float64Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
    const tree = new ClosestPoints(points, Uint32Array.from([0, 1, 2, 0, 2, 3]));
    for (const [x, y, z] of [
      [0.3, 0.4, 2],
      [-1, 0.5, 0],
      [2, 2, 1],
      [0.5, -3, -4],
      [0.2, 0.9, 0],
    ]) {
      const [dx, dy] = [Math.max(-x, 0, x - 1), Math.max(-y, 0, y - 1)];
      assert.ok(Math.abs(tree.distance(x, y, z) - Math.hypot(dx, dy, z)) < 1e-12);
    }
  });
  it("to a fine torus by its formula", async () => {
    const { points, faces } = readMesh(await sampleFile(SAMPLES.find((s) => s.id === "ring")).arrayBuffer());
    const tree = new ClosestPoints(points, faces);
    for (let k = 0; k < 200; k++) {
      const [x, y, z] = [Math.sin(12.9 * k) * 150, Math.sin(7.3 * k + 1) * 150, Math.sin(3.7 * k + 2) * 60];
      const exact = Math.abs(Math.hypot(Math.hypot(x, y) - 90, z) - 36);
      assert.ok(Math.abs(tree.distance(x, y, z) - exact) < 0.35, `${k}`);
    }
  });
});
