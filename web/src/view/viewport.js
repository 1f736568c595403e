// The 3D window: camera, light, orbit by pointer and keys, picking. Draws only when something changed.
import {
  AmbientLight,
  Color,
  DirectionalLight,
  Group,
  HemisphereLight,
  PerspectiveCamera,
  Raycaster,
  Scene,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD_OF_VIEW = 28;
const HOME = { theta: 0.7, phi: 1.16 }; // a little from the right and from above
const ASIDE = 0.35; // a place is looked at from a little beside it: that shows how it lies

export class Viewport {
  /** Puts a canvas into `host`; throws when the browser has no WebGL. */
  constructor(host, { label }) {
    this.host = host;
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, stencil: true, powerPreference: "low-power" });
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.usual = { role: "img", label };
    this.setUse(null);
    this.canvas.className = "canvas3d";
    host.append(this.canvas);

    this.scene = new Scene();
    this.root = new Group(); // turned so that the model's up axis is the world's y
    this.scene.add(this.root);
    this.camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.1, 100);
    this.lastAspect = this.camera.aspect; // what is fitted before the window has a size is fitted for this
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.draw());
    this.addLights();
    this.radius = 1;
    this.center = new Vector3(); // of what is shown, in the world
    this.frameListeners = new Set();
    this.frames = { count: 0, milliseconds: 0 };
    this.pending = false;
    this.canvas.addEventListener("keydown", (event) => this.onKey(event));
    this.canvas.addEventListener("webglcontextrestored", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
    this.home();
  }

  /** What it is to a screen reader: {role, label}; null = as it was made. */
  setUse(use) {
    const { role, label } = use ?? this.usual;
    this.canvas.setAttribute("role", role);
    this.canvas.setAttribute("aria-label", label);
  }

  addLights() {
    // The lamps go with the camera: what one looks at is lit.
    const key = new DirectionalLight(0xffffff, 1.9);
    key.position.set(-0.6, 1, 1.1);
    const fill = new DirectionalLight(0xffffff, 0.55);
    fill.position.set(1.2, -0.2, 0.6);
    this.camera.add(key, fill, key.target, fill.target);
    key.target.position.set(0, 0, -1);
    fill.target.position.set(0, 0, -1);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0x9a8f80, 0.75), new AmbientLight(0xffffff, 0.35));
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const listener of this.frameListeners) listener("resize", width, height);
    this.keepDistance();
    this.draw();
  }

  /** Asks for one frame. */
  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      const begun = performance.now();
      this.renderer.render(this.scene, this.camera);
      this.frames.count++;
      this.frames.milliseconds += performance.now() - begun;
      for (const listener of this.frameListeners) listener("frame");
    });
  }

  /** Which axis of the model points up: "x", "y", "z", or one of them with a minus. */
  setUp(axis) {
    const quarter = Math.PI / 2;
    const turns = { x: [0, quarter], y: [0, 0], z: [-quarter, 0], "-x": [0, -quarter], "-y": [2 * quarter, 0], "-z": [quarter, 0] };
    const [x, z] = turns[axis] ?? turns.z;
    this.root.rotation.set(x, 0, z);
    this.root.updateMatrixWorld(true);
    this.draw();
  }

  /** Places on a box of the model, given by half its sides, for the size along each axis: in front, where one looks. */
  edges(half) {
    const turned = new Vector3(...half).applyQuaternion(this.root.quaternion);
    const [x, y, z] = turned.toArray().map(Math.abs);
    const back = this.root.quaternion.clone().invert();
    return [0, 1, 2].map((axis) => {
      const along = new Vector3().setComponent(axis, 1).applyQuaternion(this.root.quaternion).toArray().map(Math.abs);
      const at = along[1] > 0.5 ? [-x, 0, z] : along[0] > 0.5 ? [0, -y, z] : [x, -y, 0];
      return new Vector3(...at).applyQuaternion(back).toArray();
    });
  }

  /** Shows everything within `radius` of `center` (of the model), keeping the direction of view. */
  fit(radius, center = [0, 0, 0]) {
    this.radius = radius;
    this.center = this.root.localToWorld(new Vector3(...center));
    this.controls.target.copy(this.center);
    this.place(this.distanceFor(radius));
  }

  /** The same while something moves, grows or shrinks: the user's own zoom is kept as a factor, and what was moved. */
  refit(radius, center = [0, 0, 0]) {
    const factor = this.camera.position.distanceTo(this.controls.target) / this.distanceFor(this.radius);
    this.radius = radius;
    const next = this.root.localToWorld(new Vector3(...center));
    const step = next.clone().sub(this.center);
    this.center = next;
    this.controls.target.add(step);
    this.camera.position.add(step);
    this.place(this.distanceFor(radius) * factor);
  }

  keepDistance() {
    if (this.lastAspect !== this.camera.aspect) {
      const aspect = this.camera.aspect;
      this.camera.aspect = this.lastAspect;
      const factor = this.camera.position.distanceTo(this.controls.target) / this.distanceFor(this.radius);
      this.camera.aspect = aspect;
      this.place(this.distanceFor(this.radius) * factor);
    }
    this.lastAspect = this.camera.aspect;
  }

  distanceFor(radius) {
    const half = (FIELD_OF_VIEW * Math.PI) / 360;
    const narrow = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    return (radius * 1.06) / Math.sin(narrow);
  }

  place(distance) {
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    this.camera.position.copy(this.controls.target).addScaledVector(away, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20 + this.radius * 4;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = this.radius * 0.05;
    this.controls.maxDistance = this.distanceFor(this.radius) * 8;
    this.controls.update();
    this.draw();
  }

  /** Back to the first view. */
  home() {
    this.look(HOME.theta, HOME.phi);
  }

  /** Looks at the side of the shape where a point of the model lies. */
  turnTo(point) {
    const away = this.root.localToWorld(new Vector3(...point)).sub(this.center);
    const { theta, phi } = new Spherical().setFromVector3(away);
    if (Math.hypot(away.x, away.z) < 0.05 * this.radius) return this.home();
    this.look(theta + ASIDE, (HOME.phi + Math.min(2.2, Math.max(0.6, phi))) / 2);
  }

  /** Looks from the given direction, angles in radians around and from above. */
  look(theta, phi) {
    const distance = this.distanceFor(this.radius);
    this.controls.target.copy(this.center);
    this.camera.position.setFromSpherical(new Spherical(distance, phi, theta)).add(this.center);
    this.place(distance);
  }

  onKey(event) {
    const turn = 0.12;
    const at = new Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    const keys = {
      ArrowLeft: () => {
        at.theta -= turn;
      },
      ArrowRight: () => {
        at.theta += turn;
      },
      ArrowUp: () => {
        at.phi -= turn;
      },
      ArrowDown: () => {
        at.phi += turn;
      },
      "+": () => {
        at.radius *= 0.88;
      },
      "=": () => {
        at.radius *= 0.88;
      },
      "-": () => {
        at.radius /= 0.88;
      },
      0: () => this.home(),
      Home: () => this.home(),
    };
    const action = event.ctrlKey || event.metaKey || event.altKey ? null : keys[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    if (event.key === "0" || event.key === "Home") return;
    at.makeSafe();
    this.camera.position.setFromSpherical(at).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  /** The closest hit of the pointer on `objects`, or null. */
  pick(event, objects) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray.intersectObjects(objects, false)[0] ?? null;
  }

  /** Pixel position of a point of the model, or null behind the camera. */
  project(point) {
    const at = this.root.localToWorld(new Vector3(...point)).project(this.camera);
    if (at.z > 1) return null;
    return [((at.x + 1) / 2) * this.host.clientWidth, ((1 - at.y) / 2) * this.host.clientHeight];
  }

  /** Whether something at `point` with this normal looks to the viewer; both of the model. */
  faces(point, normal) {
    const at = this.root.localToWorld(new Vector3(...point));
    const away = new Vector3(...normal).transformDirection(this.root.matrixWorld);
    return away.dot(at.sub(this.camera.position)) < 0;
  }

  /** Length in the model that one pixel covers at the given point. */
  pixelSize(point) {
    const distance = this.root.localToWorld(new Vector3(...point)).distanceTo(this.camera.position);
    return (2 * distance * Math.tan((FIELD_OF_VIEW * Math.PI) / 360)) / this.host.clientHeight;
  }

  /** The camera's right and up as directions of the model. */
  screenAxes() {
    const inverse = this.root.quaternion.clone().invert();
    const [x, y] = [new Vector3(1, 0, 0), new Vector3(0, 1, 0)];
    return [x, y].map((axis) => axis.applyQuaternion(this.camera.quaternion).applyQuaternion(inverse).toArray());
  }

  /** A small picture of all that is shown, 4 by 3, as a data URL. */
  picture(width = 256) {
    this.renderer.render(this.scene, this.camera);
    const small = document.createElement("canvas");
    small.width = width;
    small.height = width * 0.75;
    const scale = Math.min(small.width / this.canvas.width, small.height / this.canvas.height) * 1.12;
    const [w, h] = [this.canvas.width * scale, this.canvas.height * scale];
    small.getContext("2d").drawImage(this.canvas, (small.width - w) / 2, (small.height - h) / 2, w, h);
    return small.toDataURL("image/webp", 0.8);
  }

  /** listener("frame") after each frame, listener("resize", width, height) after a change of size. */
  onFrame(listener) {
    this.frameListeners.add(listener);
    return () => this.frameListeners.delete(listener);
  }
}

export { Color };
