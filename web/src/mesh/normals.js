// Normals of triangle meshes and the angle between two of them.

/** Twice the area times the unit normal of face f. */
export function faceNormal(points, faces, f) {
  const [a, b, c] = [3 * faces[3 * f], 3 * faces[3 * f + 1], 3 * faces[3 * f + 2]];
  const [ux, uy, uz] = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
  const [vx, vy, vz] = [points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]];
  return [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
}

/** Sums of the adjacent faces' normals, weighted by area; not normalised. */
export function vertexNormals(points, faces) {
  const normals = new Float64Array(points.length);
  for (let f = 0; 3 * f < faces.length; f++) {
    const normal = faceNormal(points, faces, f);
    for (let corner = 0; corner < 3; corner++) {
      const at = 3 * faces[3 * f + corner];
      for (let axis = 0; axis < 3; axis++) normals[at + axis] += normal[axis];
    }
  }
  return normals;
}

/** Degrees from 0 to 180; 0 where one of the two has no direction. */
export function angleBetween(a, b) {
  const size = Math.hypot(a[0], a[1], a[2]) * Math.hypot(b[0], b[1], b[2]);
  if (size === 0) return 0;
  return (Math.acos(Math.min(1, Math.max(-1, (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / size))) * 180) / Math.PI;
}
