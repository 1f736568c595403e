// Heavy work away from the page: reading meshes, and the distance of a mesh to its sheets.
import { ClosestPoints } from "../mesh/closest.js";
import { angleBetween, faceNormal, vertexNormals } from "../mesh/normals.js";
import { inspect } from "../mesh/inspect.js";
import { readMesh } from "../mesh/read_mesh.js";

const TASKS = {
  /** Bytes of a mesh file -> what inspect() says, with the format. */
  read({ buffer }) {
    const mesh = readMesh(buffer);
    return { format: mesh.format, ...inspect(mesh.points, mesh.faces) };
  },

  /**
   * For each vertex of the input its distance to the result, and the angle in degrees between the two surfaces there.
   * All in the same frame and unit.
   */
  compare({ vertices, indices, points, faces }) {
    const tree = new ClosestPoints(points, faces);
    const normals = vertexNormals(vertices, indices);
    const count = vertices.length / 3;
    const [distances, tilts] = [new Float32Array(count), new Float32Array(count)];
    for (let v = 0; v < count; v++) {
      distances[v] = tree.distance(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
      tilts[v] = angleBetween(normals.subarray(3 * v, 3 * v + 3), faceNormal(points, faces, tree.nearest));
    }
    return { distances, tilts };
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
  return Object.values(output)
    .filter((value) => ArrayBuffer.isView(value))
    .map((value) => value.buffer);
}
