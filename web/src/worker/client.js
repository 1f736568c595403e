// Calls the worker's tasks as promises.
import { MeshError } from "../mesh/read_mesh.js";

/* global WORKER_FILE */
let worker = null;
let lastId = 0;
const waiting = new Map();

function start() {
  const file = new URL(WORKER_FILE, import.meta.url).href;
  // Pages under `require-trusted-types-for 'script'` want to hear that this address is ours.
  const policy = window.trustedTypes?.createPolicy("sheetform-worker", { createScriptURL: (url) => url });
  worker = new Worker(policy ? policy.createScriptURL(file) : file);
  worker.onmessage = ({ data: { id, output, error } }) => {
    const { resolve, reject } = waiting.get(id);
    waiting.delete(id);
    if (error) reject(meshError(error));
    else resolve(output);
  };
  worker.onerror = () => {
    for (const { reject } of waiting.values())
      reject(new MeshError("The preview ran out of memory.", "", "Try a smaller mesh."));
    waiting.clear();
    worker = null;
  };
}

function call(task, input, transfer = []) {
  if (!worker) start();
  const id = ++lastId;
  return new Promise((resolve, reject) => {
    waiting.set(id, { resolve, reject });
    worker.postMessage({ id, task, input }, transfer);
  });
}

const meshError = ({ what, where, fix, ...more }) => Object.assign(new MeshError(what, where, fix), more);

/**
 * Reads and describes a mesh file (a Blob). Rejects with a MeshError, which of a damaged file has the description of the
 * `rest` and the `places` of the damage, relative to its centre.
 */
export async function inspectFile(file) {
  const buffer = await file.arrayBuffer();
  const { mesh, error } = await call("read", { buffer }, [buffer]);
  if (!error) return mesh;
  const places = error.places.map((place) => place.map((value, axis) => value - mesh.center[axis]));
  throw meshError({ ...error, rest: mesh, places });
}

/** Distances and tilts of a mesh (vertices, indices) against the triangles (points, faces); all arrays are copied. */
export function compareWith(vertices, indices, points, faces) {
  return call("compare", { vertices, indices, points, faces });
}
