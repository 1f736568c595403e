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
    if (error) reject(new MeshError(error.what, error.where, error.fix));
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

/** Reads and describes a mesh file (a Blob). Rejects with a MeshError. */
export async function inspectFile(file) {
  const buffer = await file.arrayBuffer();
  return call("read", { buffer }, [buffer]);
}

/** Distances and tilts of a mesh (vertices, indices) against the triangles (points, faces); all arrays are copied. */
export function compareWith(vertices, indices, points, faces) {
  return call("compare", { vertices, indices, points, faces });
}
