// What was drawn on the mesh, in the 3D window: seams as lines, areas without seams as hatching on the surface itself.
import {
  AlwaysStencilFunc,
  BackSide,
  Color,
  DecrementWrapStencilOp,
  FrontSide,
  Group,
  IcosahedronGeometry,
  IncrementWrapStencilOp,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  NotEqualStencilFunc,
  PlaneGeometry,
  ShaderMaterial,
} from "three";
import { alongStroke } from "../guides.js";
import { fatLines, setSegments } from "./fat_lines.js";
import { themeColor } from "./theme.js";

const SETTING_DOWN = 1 / 3; // of the radius: from one place of the brush to the next

export class GuideObject {
  /** @param center of the mesh, which is drawn around the origin */
  constructor(center) {
    this.center = center;
    this.group = new Group();
    this.lines = [lines(4, { polygonOffset: true, polygonOffsetFactor: -4, polygonOffsetUnits: -8 })];
    this.lines.push(lines(4, { depthTest: false, opacity: 0.25 })); // behind the shape: faint
    this.chosen = lines(7, { depthTest: false, opacity: 0.7 });
    this.group.add(...this.lines, this.chosen);
    this.hatch = hatching();
    this.balls = [];
    this.recolor();
    this.show([]);
  }

  recolor() {
    for (const object of this.lines) object.material.color.set(themeColor("--accent"));
    this.chosen.material.color.set(themeColor("--warn"));
    this.hatch.material.uniforms.color.value.set(themeColor("--bad"));
  }

  setResolution(width, height) {
    for (const object of [...this.lines, this.chosen]) object.material.resolution.set(width, height);
  }

  /** Draws strokes as in Guides; `chosen` is one of them, or null. */
  show(strokes, chosen = null) {
    const seams = strokes.filter(({ kind }) => kind === "seam");
    for (const object of this.lines) setSegments(object, seams.flatMap((stroke) => this.segments(stroke)));
    setSegments(this.chosen, chosen ? this.segments(chosen) : []);
    this.setBalls(
      strokes
        .filter(({ kind }) => kind === "keep_out")
        .flatMap(({ points, radius }) =>
          alongStroke(points, radius * SETTING_DOWN).map((place) => [this.local(place), radius]),
        ),
    );
  }

  local = (place) => place.map((value, axis) => value - this.center[axis]);

  /** Coordinates of the ends of a stroke's segments. */
  segments({ points, closed }) {
    const all = (closed ? [...points, points[0]] : points).map(this.local);
    return all.slice(1).flatMap((place, k) => [...all[k], ...place]);
  }

  /**
   * Balls that are never seen: they mark in the stencil where the surface lies inside of one (behind its front, before
   * its back), and the hatching is drawn there.
   */
  setBalls(places) {
    for (const object of this.balls) object.dispose();
    this.group.remove(...this.balls, this.hatch);
    this.balls = places.length > 0 ? [balls(BackSide, places), balls(FrontSide, places)] : [];
    if (places.length > 0) this.group.add(...this.balls, this.hatch);
  }

  dispose() {
    for (const object of [...this.lines, this.chosen, this.hatch]) {
      object.geometry.dispose();
      object.material.dispose();
    }
    for (const object of this.balls) object.dispose();
  }
}

function lines(width, look) {
  const object = fatLines(width, look);
  object.renderOrder = 8;
  return object;
}

const ball = new IcosahedronGeometry(1, 3);
const marking = Object.fromEntries(
  [
    [BackSide, IncrementWrapStencilOp],
    [FrontSide, DecrementWrapStencilOp],
  ].map(([side, operation]) => [
    side,
    new MeshBasicMaterial({
      side,
      transparent: true, // drawn after the surface
      colorWrite: false,
      depthWrite: false,
      stencilWrite: true,
      stencilFunc: AlwaysStencilFunc,
      stencilZFail: operation,
    }),
  ]),
);

function balls(side, places) {
  const object = new InstancedMesh(ball, marking[side], places.length);
  const at = new Matrix4();
  places.forEach(([place, radius], k) =>
    object.setMatrixAt(k, at.makeScale(radius, radius, radius).setPosition(...place)),
  );
  object.frustumCulled = false;
  object.renderOrder = 5;
  return object;
}

/** Covers the whole window, and is drawn where the stencil is marked. */
function hatching() {
  const object = new Mesh(
    new PlaneGeometry(2, 2),
    new ShaderMaterial({
      transparent: true,
      depthTest: false,
      depthWrite: false,
      stencilWrite: true,
      stencilFunc: NotEqualStencilFunc,
      uniforms: { color: { value: new Color() } },
      vertexShader: "void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }",
      fragmentShader: `
        uniform vec3 color;
        void main() {
          float stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 12.0) < 4.0 ? 0.75 : 0.3;
          gl_FragColor = vec4(color, stripe);
          #include <colorspace_fragment>
        }`,
    }),
  );
  object.frustumCulled = false;
  object.renderOrder = 6;
  return object;
}
