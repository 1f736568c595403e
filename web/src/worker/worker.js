// Heavy work away from the page: reading meshes, and the distance of a mesh to its sheets.
import { ClosestPoints } from "../mesh/closest.js";
import { inspect } from "../mesh/inspect.js";
import { readMesh } from "../mesh/read_mesh.js";

const TASKS = {
  /** Bytes of a mesh file -> what inspect() says, with the format. */
  read({ buffer }) {
    const mesh = readMesh(buffer);
    return { format: mesh.format, ...inspect(mesh.points, mesh.faces) };
  },

  /** For each vertex of the input its distance to the result, and the largest of them. All in the same frame and unit. */
  distance({ vertices, points, faces }) {
    const tree = new ClosestPoints(points, faces);
    const count = vertices.length / 3;
    const distances = new Float32Array(count);
    let worst = 0;
    for (let v = 0; v < count; v++) {
      distances[v] = tree.distance(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
      if (distances[v] > distances[worst]) worst = v;
    }
    return { distances, worst };
  },
};

self.onmessage = ({ data: { id, task, input } }) => {
  try {
    const output = TASKS[task](input);
    self.postMessage({ id, output }, transferables(output));
  } catch (error) {
    self.postMessage({ id, error: { what: error.message, where: error.where ?? "", fix: error.fix ?? "" } });
  }
};

function transferables(output) {
  return Object.values(output).filter((value) => ArrayBuffer.isView(value)).map((value) => value.buffer);
}
