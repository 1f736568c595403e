// Heavy work away from the page: reading meshes, and the distance of a mesh to its sheets.
import { ClosestPoints } from "../mesh/closest.js";
import { angleBetween, faceNormal, vertexNormals } from "../mesh/normals.js";
import { inspect } from "../mesh/inspect.js";
import { readMesh } from "../mesh/read_mesh.js";

const TASKS = {
  /** Bytes of a mesh file -> {mesh: what inspect() says, with the format}; of a damaged file the error, too. */
  read({ buffer }) {
    try {
      return { mesh: described(readMesh(buffer)) };
    } catch (error) {
      if (!error.rest) throw error;
      const { message: what, where, fix, places } = error;
      return { mesh: described(error.rest), error: { what, where, fix, places } };
    }
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

const described = ({ format, points, faces }) => ({ format, ...inspect(points, faces) });

self.onmessage = ({ data: { id, task, input } }) => {
  try {
    const output = TASKS[task](input);
    self.postMessage({ id, output }, transferables(output));
  } catch (error) {
    self.postMessage({ id, error: { what: error.message, where: error.where ?? "", fix: error.fix ?? "" } });
  }
};

function transferables(output) {
  return Object.values(output.mesh ?? output)
    .filter((value) => ArrayBuffer.isView(value))
    .map((value) => value.buffer);
}
