// Lines of a width in pixels.
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

/** @param look further properties of the material */
export function fatLines(width, look = {}) {
  const object = new LineSegments2(
    new LineSegmentsGeometry(),
    new LineMaterial({ linewidth: width, transparent: true, ...look }),
  );
  object.frustumCulled = false;
  return object;
}

/**
 * Other segments, as coordinates of their ends; none hides the lines. The geometry is a new one: the old one would
 * never draw more segments than it had at first.
 */
export function setSegments(object, coordinates) {
  object.visible = coordinates.length > 0;
  if (!object.visible) return;
  object.geometry.dispose();
  object.geometry = new LineSegmentsGeometry();
  object.geometry.setPositions(coordinates);
}
