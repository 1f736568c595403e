// The uploaded mesh in the 3D window: the surface, its borders, places to look at, and the box with its size.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshLambertMaterial,
} from "three";
import { fatLines, setSegments } from "./fat_lines.js";
import { Marks } from "./marks.js";
import { heatColor, themeColor } from "./theme.js";

export class InputObject {
  /** @param mesh what inspect() says */
  constructor(mesh) {
    this.mesh = mesh;
    this.group = new Group();
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(mesh.positions, 3));
    geometry.setIndex(new BufferAttribute(mesh.indices, 1));
    geometry.computeBoundingSphere();
    this.geometry = geometry;
    this.material = new MeshLambertMaterial({
      side: DoubleSide,
      flatShading: true,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
    this.surface = new Mesh(geometry, this.material);
    this.borders = lines(mesh.borders);
    this.crowded = fatLines(4, { polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
    setSegments(this.crowded, mesh.crowded);
    this.box = boxLines(mesh.box, mesh.center);
    this.marks = new Marks();
    this.group.add(this.surface, this.borders, this.crowded, this.box, this.marks.group);
    this.radius = radiusOf(mesh);
    this.recolor();
  }

  setResolution(width, height) {
    this.crowded.material.resolution.set(width, height);
  }

  recolor() {
    this.material.color.set(this.heat ? 0xffffff : themeColor("--mesh"));
    this.borders.material.color.set(themeColor("--accent"));
    this.crowded.material.color.set(themeColor("--bad"));
    this.box.material.color.set(themeColor("--ink-faint"));
    this.marks.recolor();
  }

  /** Colours the surface by a value per vertex; `full` is the value of the last colour. null = plain. */
  setHeat(values, full = 1) {
    this.heat = values;
    this.material.vertexColors = Boolean(values);
    if (values) {
      const colors = new Float32Array(values.length * 3);
      const color = new Color();
      values.forEach((value, v) => colors.set(color.setRGB(...heatColor(value / full), "srgb").toArray(), 3 * v));
      this.geometry.setAttribute("color", new BufferAttribute(colors, 3));
    }
    this.material.needsUpdate = true;
    this.recolor();
  }

  /** As an overlay over the result: a ghost, without box. */
  asGhost(on) {
    this.box.visible = this.borders.visible = !on;
    this.crowded.visible = !on && this.mesh.crowded.length > 0;
    Object.assign(this.material, { transparent: on, opacity: on ? 0.38 : 1, depthWrite: !on });
    this.material.needsUpdate = true;
  }

  /** Marks places (points relative to the centre) by small balls. */
  markPlaces(points) {
    this.marks.show(points, this.radius);
  }

  dispose() {
    for (const object of [this.surface, this.borders, this.crowded, this.box]) {
      object.geometry.dispose();
      object.material.dispose();
    }
    this.marks.dispose();
  }
}

function lines(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  return new LineSegments(geometry, new LineBasicMaterial());
}

function radiusOf({ box }) {
  return Math.hypot(...box.max.map((high, axis) => high - box.min[axis])) / 2 || 1;
}

/** The twelve edges of the box as short corner brackets: size without a cage. */
function boxLines({ min, max }, center) {
  const points = [];
  const share = 0.12;
  for (let corner = 0; corner < 8; corner++) {
    const at = [0, 1, 2].map((axis) => ((corner >> axis) & 1 ? max[axis] : min[axis]) - center[axis]);
    for (let axis = 0; axis < 3; axis++) {
      const to = [...at];
      to[axis] *= 1 - 2 * share;
      points.push(...at, ...to);
    }
  }
  const object = lines(Float32Array.from(points));
  object.material.transparent = true;
  object.material.opacity = 0.7;
  return object;
}
