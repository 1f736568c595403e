// Reads STL, OBJ, PLY and OFF for the preview. The server reads the file again by its own, stricter reader; this one
// only has to show what was dropped, quickly, and to say in words when a file is no mesh.

export const MAX_PREVIEW_FACES = 4_000_000;

/** What is wrong with a file, for people: what, where, fix. */
export class MeshError extends Error {
  constructor(what, where = "", fix = "") {
    super(what);
    this.where = where;
    this.fix = fix;
  }
}

const decoder = new TextDecoder("utf-8", { fatal: false });

/**
 * Reads the bytes of a mesh file.
 * @returns {{format: string, points: Float64Array, faces: Uint32Array}} x, y, z of each vertex; three indices a triangle
 */
export function readMesh(buffer) {
  const bytes = new Uint8Array(buffer);
  if (bytes.length === 0)
    throw new MeshError("The file is empty.", "", "Export the mesh again and choose the new file.");
  const head = decoder.decode(bytes.subarray(0, 512));
  const format = formatOf(head, bytes);
  const mesh = { stl: readStl, ply: readPly, off: readOff, obj: readObj }[format](bytes, head);
  if (mesh.faces.length === 0) {
    throw new MeshError(
      "The file has no faces.",
      "",
      "Export a surface made of triangles, not points, lines or a CAD solid.",
    );
  }
  return { format, ...mesh };
}

function formatOf(head, bytes) {
  if (/^ply\s/.test(head)) return "ply";
  if (/^\s*(?:#[^\n]*\n\s*)*(?:ST)?C?N?4?n?OFF\b/.test(head)) return "off";
  if (isBinaryStl(bytes) || /^\s*solid\b/.test(head)) return "stl";
  if (/^\s*(?:#|v |vn |vt |o |g |mtllib|usemtl|s )/m.test(head)) return "obj";
  throw new MeshError(
    "This is not a mesh of a known format.",
    "start of the file",
    "Choose an STL, OBJ, PLY or OFF file. CAD programs write STL by “export” or “save as mesh”.",
  );
}

function isBinaryStl(bytes) {
  if (bytes.length < 84) return false;
  const count = new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);
  return bytes.length === 84 + 50 * count;
}

function tooLarge() {
  return new MeshError(
    `The file has more than ${MAX_PREVIEW_FACES.toLocaleString("en")} triangles, too many to show here.`,
    "",
    "Reduce the mesh first: 20,000 to 200,000 triangles are plenty for sheets.",
  );
}

/** Growing arrays of numbers; typed, because a million vertices do not fit well into a plain list. */
class Grow {
  constructor(Type, size = 1 << 14) {
    this.data = new Type(size);
    this.length = 0;
  }
  push3(a, b, c) {
    if (this.length + 3 > this.data.length) {
      const wider = new this.data.constructor(this.data.length * 2);
      wider.set(this.data);
      this.data = wider;
    }
    this.data[this.length++] = a;
    this.data[this.length++] = b;
    this.data[this.length++] = c;
  }
  done() {
    return this.data.slice(0, this.length);
  }
}

/** Lines of the file without building one huge string. Calls each(line, number). */
function eachLine(bytes, each, start = 0) {
  let number = 1;
  for (let from = start; from < bytes.length; number++) {
    let end = bytes.indexOf(10, from);
    if (end < 0) end = bytes.length;
    each(decoder.decode(bytes.subarray(from, end)), number);
    from = end + 1;
  }
}

function finite(text, number) {
  const value = Number.parseFloat(text);
  if (!Number.isFinite(value)) {
    throw new MeshError(
      `“${String(text).slice(0, 20)}” is not a number.`,
      `line ${number}`,
      "Export the mesh again; the file is damaged.",
    );
  }
  return value;
}

function fan(faces, corners) {
  for (let k = 1; k + 1 < corners.length; k++) faces.push3(corners[0], corners[k], corners[k + 1]);
  if (faces.length > 3 * MAX_PREVIEW_FACES) throw tooLarge();
}

function readObj(bytes) {
  const points = new Grow(Float64Array);
  const faces = new Grow(Uint32Array);
  eachLine(bytes, (line, number) => {
    const words = line.trim().split(/\s+/);
    if (words[0] === "v") {
      if (words.length < 4)
        throw new MeshError("A vertex has fewer than three coordinates.", `line ${number}`, "Export the mesh again.");
      points.push3(finite(words[1], number), finite(words[2], number), finite(words[3], number));
    } else if (words[0] === "f") {
      fan(
        faces,
        words.slice(1).map((word) => objIndex(word, points.length / 3, number)),
      );
    }
  });
  return checked(points, faces);
}

function objIndex(word, count, number) {
  const index = Number.parseInt(word, 10);
  const zeroBased = index < 0 ? count + index : index - 1;
  if (!(zeroBased >= 0 && index !== 0)) {
    throw new MeshError(
      `A face names vertex “${word}”, which is not there.`,
      `line ${number}`,
      "Export the mesh again; the file is damaged.",
    );
  }
  return zeroBased;
}

function checked(points, faces) {
  const count = points.length / 3;
  const indices = faces.done();
  for (let k = 0; k < indices.length; k++) {
    if (indices[k] >= count) {
      throw new MeshError(
        `Face ${Math.floor(k / 3) + 1} names vertex ${indices[k] + 1}, but there are only ${count}.`,
        "",
        "The file is damaged or was cut short; export it again.",
      );
    }
  }
  return { points: points.done(), faces: indices };
}

function readStl(bytes, head) {
  if (isBinaryStl(bytes)) return readBinaryStl(bytes);
  if (!/facet|endsolid/i.test(decoder.decode(bytes.subarray(0, 4096))) || !/^\s*solid/.test(head)) {
    throw new MeshError(
      "The STL file is cut short or not an STL file.",
      "",
      "Export or copy it again; its length does not fit its triangle count.",
    );
  }
  const points = new Grow(Float64Array);
  eachLine(bytes, (line, number) => {
    const match = /^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)/i.exec(line);
    if (match) points.push3(finite(match[1], number), finite(match[2], number), finite(match[3], number));
    if (points.length > 9 * MAX_PREVIEW_FACES) throw tooLarge();
  });
  return soup(points.done());
}

function readBinaryStl(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const count = view.getUint32(80, true);
  if (count > MAX_PREVIEW_FACES) throw tooLarge();
  const points = new Float64Array(9 * count);
  for (let face = 0; face < count; face++) {
    for (let k = 0; k < 9; k++) {
      const value = view.getFloat32(84 + 50 * face + 12 + 4 * k, true);
      if (!Number.isFinite(value))
        throw new MeshError(
          "A corner is not a number.",
          `face ${face + 1}`,
          "Export the mesh again; the file is damaged.",
        );
      points[9 * face + k] = value;
    }
  }
  return soup(points);
}

function soup(points) {
  return { points, faces: Uint32Array.from({ length: Math.floor(points.length / 9) * 3 }, (_, k) => k) };
}

function readOff(bytes) {
  const words = [];
  let header = "";
  eachLine(bytes, (line) => {
    const text = line.replace(/#.*/, "").trim();
    if (!text) return;
    if (!header) {
      const match = /^\S*OFF\b(.*)/.exec(text);
      header = match ? match[0] : "OFF";
      if (match?.[1].trim()) words.push(match[1].trim().split(/\s+/));
      return;
    }
    words.push(text.split(/\s+/));
  });
  if (/BINARY/i.test(header))
    throw new MeshError("Binary OFF files cannot be shown.", "", "Save it as text OFF, or as STL, OBJ or PLY.");
  const [vertexCount, faceCount] = (words[0] || []).map(Number);
  if (!(vertexCount >= 0 && faceCount >= 0) || words.length < 1 + vertexCount + faceCount) {
    throw new MeshError("The OFF file is cut short: its counts do not fit its lines.", "", "Export or copy it again.");
  }
  const points = new Grow(Float64Array);
  const faces = new Grow(Uint32Array);
  for (let k = 0; k < vertexCount; k++)
    points.push3(...words[1 + k].slice(0, 3).map((w) => finite(w, `of vertex ${k + 1}`)));
  for (let k = 0; k < faceCount; k++) {
    const row = words[1 + vertexCount + k].map(Number);
    fan(faces, row.slice(1, 1 + row[0]));
  }
  return checked(points, faces);
}

const PLY_SIZE = {
  char: 1,
  uchar: 1,
  int8: 1,
  uint8: 1,
  short: 2,
  ushort: 2,
  int16: 2,
  uint16: 2,
  int: 4,
  uint: 4,
  int32: 4,
  uint32: 4,
  float: 4,
  float32: 4,
  double: 8,
  float64: 8,
};
const PLY_READ = {
  char: "getInt8",
  int8: "getInt8",
  uchar: "getUint8",
  uint8: "getUint8",
  short: "getInt16",
  int16: "getInt16",
  ushort: "getUint16",
  uint16: "getUint16",
  int: "getInt32",
  int32: "getInt32",
  uint: "getUint32",
  uint32: "getUint32",
  float: "getFloat32",
  float32: "getFloat32",
  double: "getFloat64",
  float64: "getFloat64",
};

function plyHeader(bytes) {
  const text = decoder.decode(bytes.subarray(0, 1 << 16));
  const match = /end_header\r?\n/.exec(text);
  if (!match) throw new MeshError("The PLY file's header has no end.", "start of the file", "Export the mesh again.");
  const elements = [];
  let format = "";
  for (const line of text.slice(0, match.index).split(/\r?\n/)) {
    const words = line.trim().split(/\s+/);
    if (words[0] === "format") format = words[1];
    if (words[0] === "element") elements.push({ name: words[1], count: Number(words[2]), properties: [] });
    if (words[0] === "property" && elements.length > 0) {
      const list = words[1] === "list";
      elements
        .at(-1)
        .properties.push(
          list ? { name: words[4], count: words[2], type: words[3] } : { name: words[2], type: words[1] },
        );
    }
  }
  return { format, elements, start: new TextEncoder().encode(text.slice(0, match.index + match[0].length)).length };
}

function readPly(bytes) {
  const { format, elements, start } = plyHeader(bytes);
  const points = new Grow(Float64Array);
  const faces = new Grow(Uint32Array);
  const next = format === "ascii" ? plyWords(bytes, start) : plyNumbers(bytes, start, format !== "binary_big_endian");
  for (const element of elements) {
    for (let row = 0; row < element.count; row++) {
      const values = {};
      for (const property of element.properties) {
        if (!property.count) {
          values[property.name] = next(property.type);
          continue;
        }
        const length = next(property.count);
        if (!(length >= 0 && length < 1e6))
          throw new MeshError(
            "A face of the PLY file has no sensible length.",
            `face ${row + 1}`,
            "Export the mesh again.",
          );
        values[property.name] = Array.from({ length }, () => next(property.type));
      }
      if (element.name === "vertex") points.push3(values.x, values.y, values.z);
      if (element.name === "face") fan(faces, values.vertex_indices ?? values.vertex_index ?? []);
    }
  }
  return checked(points, faces);
}

function cutShort() {
  return new MeshError(
    "The PLY file is cut short.",
    "",
    "Export or copy it again; it ends before all of its vertices and faces.",
  );
}

function plyWords(bytes, start) {
  const words = decoder.decode(bytes.subarray(start)).split(/\s+/);
  let k = words[0] === "" ? 1 : 0;
  return () => {
    if (k >= words.length || words[k] === "") throw cutShort();
    return finite(words[k++], "of the PLY file");
  };
}

function plyNumbers(bytes, start, little) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  let at = start;
  return (type) => {
    const size = PLY_SIZE[type];
    if (!size || at + size > bytes.length) throw cutShort();
    const value = view[PLY_READ[type]](at, little);
    at += size;
    if (!Number.isFinite(value))
      throw new MeshError("A coordinate is not a number.", "", "Export the mesh again; the file is damaged.");
    return value;
  };
}
