// Places that the server talks about: of what is wrong with a mesh, and of what was repaired.

/** Places in the mesh that a problem names ("face 12", "vertex 7", "(1.5, 2, 3)"), relative to the mesh's centre. */
export function placesOf(problem, mesh) {
  const places = [];
  for (const text of [problem?.where, ...(problem?.errors ?? []).map((item) => item.detail)]) {
    for (const match of String(text ?? "").matchAll(
      /\(\s*(-?[\d.eE+-]+)\s*,\s*(-?[\d.eE+-]+)\s*,\s*(-?[\d.eE+-]+)\s*\)/g,
    )) {
      places.push(match.slice(1, 4).map((value, axis) => Number(value) - mesh.center[axis]));
    }
    for (const match of String(text ?? "").matchAll(/\bface (\d+)/g)) {
      const k = 3 * Number(match[1]);
      if (k + 2 >= mesh.indices.length) continue;
      places.push(
        [0, 1, 2].map((axis) =>
          [0, 1, 2].reduce((sum, corner) => sum + mesh.positions[3 * mesh.indices[k + corner] + axis] / 3, 0),
        ),
      );
    }
  }
  return places.filter((place) => place.every(Number.isFinite)).slice(0, 200);
}

/**
 * What was repaired, as [{text, places}]; places relative to `center`. Vertices that were merged are no flaw: in STL
 * every corner of a triangle stands for itself.
 */
export function repairsOf(layout, center) {
  return (layout.audit?.findings ?? [])
    .filter(({ kind }) => kind !== "duplicate-vertex" && kind !== "unused-vertex")
    .map(({ text, places = [] }) => ({
      text,
      places: places.map((place) => place.map((value, axis) => value - center[axis])),
    }))
    .filter(({ places }) => places.length > 0);
}
