// Reads STL, OBJ, PLY and OFF for the preview. The server reads the file again by its own, stricter reader; this one
// only has to show what was dropped, quickly, and to say in words when a file is no mesh. Of a damaged file it reads what
// is whole, so that the place of the damage can be shown.

const MAX_PREVIEW_FACES = 4_000_000;

const MOST_PLACES = 200;
const NOWHERE = 0xffffffff; // a vertex that is not there

/**
 * What is wrong with a file, for people: what, where, fix. Of a damaged file `rest` is what could be read, as readMesh
 * says it, and `places` are the points ([x, y, z], units of the file) where it is damaged.
 */
export class MeshError extends Error {
  rest = null;
  places = [];

  constructor(what, where = "", fix = "") {
    super(what);
    this.where = where;
    this.fix = fix;
  }
}

const decoder = new TextDecoder("utf-8", { fatal: false });

/**
 * Reads the bytes of a mesh file. Throws a MeshError.
 * @returns {{format: string, points: Float64Array, faces: Uint32Array}} x, y, z of each vertex; three indices a triangle
 */
export function readMesh(buffer) {
  const bytes = new Uint8Array(buffer);
  if (bytes.length === 0)
    throw new MeshError("The file is empty.", "", "Export the mesh again and choose the new file.");
  const head = decoder.decode(bytes.subarray(0, 512));
  const format = formatOf(head, bytes);
  const reading = new Reading();
  ({ stl: readStl, ply: readPly, off: readOff, obj: readObj })[format](bytes, reading);
  return { format, ...reading.done(format) };
}

function formatOf(head, bytes) {
  if (/^ply\s/.test(head)) return "ply";
  if (/^\s*(?:#[^\n]*\n\s*)*(?:ST)?C?N?4?n?OFF\b/.test(head)) return "off";
  if (isBinaryStl(bytes) || /^\s*solid\b/.test(head) || isCutStl(head, bytes)) return "stl";
  if (/^\s*(?:#|v |vn |vt |o |g |mtllib|usemtl|s )/m.test(head)) return "obj";
  throw new MeshError(
    "This is not a mesh of a known format.",
    "start of the file",
    "Choose an STL, OBJ, PLY or OFF file. CAD programs write STL by “export” or “save as mesh”.",
  );
}

/** Bytes that a binary STL of as many triangles as its head says would have; 0 where there is no head. */
const stlLength = (bytes) =>
  bytes.length < 84 ? 0 : 84 + 50 * new DataView(bytes.buffer, bytes.byteOffset).getUint32(80, true);

/** Some programs write a few bytes more. */
function isBinaryStl(bytes) {
  const length = stlLength(bytes);
  return length > 0 && bytes.length >= length && bytes.length < length + 50;
}

/** Nothing but a binary STL that ends too early: no text, and its head says more triangles than there are. */
const isCutStl = (head, bytes) => head.includes("\0") && bytes.length > 134 && bytes.length < stlLength(bytes);

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

const DAMAGED = "Export the mesh again; the file is damaged.";

/** What is read of a file, and the first thing that is wrong with it. Nothing is thrown as long as one can read on. */
class Reading {
  points = new Grow(Float64Array);
  faces = new Grow(Uint32Array);
  fault = null;
  places = [];
  holes = false; // whether some vertex has no place

  wrong(what, where, fix = DAMAGED) {
    this.fault ??= new MeshError(what, where, fix);
  }

  /** The file ends too early: where the last triangle lies. */
  cutShort(what, fix = "Export or copy it again.") {
    this.wrong(what, "", fix);
    this.endsHere = true;
  }

  number(word, where) {
    const value = Number.parseFloat(word);
    if (!Number.isFinite(value)) this.wrong(`“${String(word).slice(0, 20)}” is not a number.`, where);
    return value;
  }

  /** where(): told only of a vertex that has no place. */
  vertex(x, y, z, where) {
    if (!(Number.isFinite(x) && Number.isFinite(y) && Number.isFinite(z))) {
      this.wrong("A corner has no place: a coordinate is not a number.", where());
      this.holes = true;
    }
    this.points.push3(x, y, z);
  }

  /** A polygon as triangles; what is no number of a vertex names one that is not there. */
  face(polygon) {
    const corners = polygon.map((v) => (v >= 0 ? v : NOWHERE));
    for (let k = 1; k + 1 < corners.length; k++) this.faces.push3(corners[0], corners[k], corners[k + 1]);
    if (this.faces.length > 3 * MAX_PREVIEW_FACES) throw tooLarge();
  }

  /** Whether a vertex is there and has a place. */
  isWhole(v) {
    const { data, length } = this.points;
    if (3 * v >= length) return false;
    return !this.holes || [0, 1, 2].every((axis) => Number.isFinite(data[3 * v + axis]));
  }

  place(v) {
    return Array.from(this.points.data.subarray(3 * v, 3 * v + 3));
  }

  /** The triangles without those that are broken, whose other corners are the places of the damage. */
  wholeFaces() {
    const { data, length } = this.faces;
    let kept = 0;
    for (let k = 0; k < length; k += 3) {
      if (this.isWhole(data[k]) && this.isWhole(data[k + 1]) && this.isWhole(data[k + 2])) {
        if (kept < k) data.copyWithin(kept, k, k + 3);
        kept += 3;
        continue;
      }
      const corners = data.subarray(k, k + 3);
      const count = this.points.length / 3;
      const missing = corners.find((v) => v >= count);
      if (missing !== undefined)
        this.wrong(`Face ${k / 3 + 1} names vertex ${missing + 1}, but there are only ${count}.`, `face ${k / 3 + 1}`);
      for (const v of corners)
        if (this.isWhole(v) && this.places.length < MOST_PLACES) this.places.push(this.place(v));
    }
    return data.slice(0, kept);
  }

  done(format) {
    const faces = this.wholeFaces();
    const points = this.points.done();
    if (!this.fault && faces.length > 0) return { points, faces };
    const error =
      this.fault ??
      new MeshError("The file has no faces.", "", "Export a surface made of triangles, not points, lines or a CAD solid.");
    if (faces.length > 0) {
      if (this.endsHere) this.places.push(...Array.from(faces.subarray(-3), (v) => this.place(v)));
      // What has no place is used by no triangle.
      for (let k = 0; k < points.length; k++) if (!Number.isFinite(points[k])) points[k] = 0;
      error.rest = { format, points, faces };
      error.places = this.places;
    }
    throw error;
  }
}

function readObj(bytes, reading) {
  eachLine(bytes, (line, number) => {
    const words = line.trim().split(/\s+/);
    const where = `line ${number}`;
    if (words[0] === "v") {
      if (words.length < 4) reading.wrong("A vertex has fewer than three coordinates.", where);
      const [x, y, z] = [1, 2, 3].map((k) => (k < words.length ? reading.number(words[k], where) : NaN));
      reading.vertex(x, y, z, () => where);
    } else if (words[0] === "f") {
      reading.face(words.slice(1).map((word) => objIndex(word, reading, where)));
    }
  });
}

/** OBJ counts from 1, or backwards from the last vertex so far. */
function objIndex(word, reading, where) {
  const index = Number.parseInt(word, 10);
  const fromZero = index < 0 ? reading.points.length / 3 + index : index - 1;
  if (fromZero >= 0) return fromZero;
  reading.wrong(`A face names vertex “${word}”, which is not there.`, where);
  return NOWHERE;
}

function readStl(bytes, reading) {
  if (stlLength(bytes) > 0 && (isBinaryStl(bytes) || isCutStl(decoder.decode(bytes.subarray(0, 512)), bytes)))
    return readBinaryStl(bytes, reading);
  let corners = 0;
  let facets = 0;
  eachLine(bytes, (line, number) => {
    const match = /^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)/i.exec(line);
    if (match) {
      const [x, y, z] = match.slice(1).map((word) => reading.number(word, `line ${number}`));
      reading.vertex(x, y, z, () => `line ${number}`);
      if (++corners % 3 === 0) reading.face([corners - 3, corners - 2, corners - 1]);
    } else if (/^\s*facet\b/i.test(line)) facets++;
  });
  if (corners < 3 * facets) reading.cutShort("The STL file is cut short: its last triangle is not whole.");
}

function readBinaryStl(bytes, reading) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  const told = view.getUint32(80, true);
  const count = Math.min(told, Math.floor((bytes.length - 84) / 50));
  if (count > MAX_PREVIEW_FACES) throw tooLarge();
  for (let face = 0; face < count; face++) {
    const where = () => `face ${face + 1}`;
    for (let at = 84 + 50 * face + 12; at < 84 + 50 * face + 48; at += 12) {
      const [x, y, z] = [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
      reading.vertex(x, y, z, where);
    }
    reading.faces.push3(3 * face, 3 * face + 1, 3 * face + 2);
  }
  if (count < told)
    reading.cutShort(
      `The STL file is cut short: of ${told.toLocaleString("en")} triangles ${count.toLocaleString("en")} are there.`,
    );
}

function readOff(bytes, reading) {
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
  const rows = words.slice(1);
  if (!(vertexCount >= 0 && faceCount >= 0) || rows.length < vertexCount + faceCount)
    reading.cutShort("The OFF file is cut short: its counts do not fit its lines.");
  rows.slice(0, vertexCount).forEach((row, k) => {
    const where = `vertex ${k + 1}`;
    reading.vertex(...[0, 1, 2].map((axis) => reading.number(row[axis], where)), () => where);
  });
  for (const row of rows.slice(vertexCount, vertexCount + faceCount)) {
    const corners = row.map(Number);
    reading.face(corners.slice(1, 1 + corners[0]));
  }
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

function readPly(bytes, reading) {
  const { format, elements, start } = plyHeader(bytes);
  const little = format !== "binary_big_endian";
  const next = format === "ascii" ? plyWords(bytes, start, reading) : plyNumbers(bytes, start, little);
  try {
    for (const element of elements) {
      for (let row = 0; row < element.count; row++) readPlyRow(element, row, next, reading);
    }
  } catch (end) {
    if (end !== END) throw end;
    reading.cutShort(
      "The PLY file is cut short.",
      "Export or copy it again; it ends before all of its vertices and faces.",
    );
  }
}

/** Thrown where the bytes end, or make no sense any more. */
const END = Symbol("end");

function readPlyRow({ name, properties }, row, next, reading) {
  const values = {};
  for (const property of properties) {
    if (!property.count) {
      values[property.name] = next(property.type);
      continue;
    }
    const length = next(property.count);
    if (!(length >= 0 && length < 1e6)) {
      reading.wrong("A face of the PLY file has no sensible length.", `face ${row + 1}`);
      throw END;
    }
    values[property.name] = Array.from({ length }, () => next(property.type));
  }
  if (name === "vertex") reading.vertex(values.x, values.y, values.z, () => `vertex ${row + 1}`);
  if (name === "face") reading.face(values.vertex_indices ?? values.vertex_index ?? []);
}

function plyWords(bytes, start, reading) {
  const words = decoder.decode(bytes.subarray(start)).split(/\s+/);
  let k = words[0] === "" ? 1 : 0;
  return () => {
    if (k >= words.length || words[k] === "") throw END;
    return reading.number(words[k++], "the PLY file");
  };
}

function plyNumbers(bytes, start, little) {
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  let at = start;
  return (type) => {
    const size = PLY_SIZE[type];
    if (!size || at + size > bytes.length) throw END;
    const value = view[PLY_READ[type]](at, little);
    at += size;
    return value;
  };
}
