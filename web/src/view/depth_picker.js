// Where pixels of the 3D window lie on a surface: its depth is drawn once, then every pixel is looked up. However large
// the mesh, following a pointer costs nothing.
import { Color, DoubleSide, NearestFilter, ShaderMaterial, Vector3, WebGLRenderTarget } from "three";

// Depth in three bytes; the fourth tells surface from nothing.
const material = new ShaderMaterial({
  side: DoubleSide,
  vertexShader: "void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
  fragmentShader: `
    void main() {
      float depth = min(gl_FragCoord.z, 0.99999994) * 256.0;
      float high = floor(depth);
      depth = (depth - high) * 256.0;
      float middle = floor(depth);
      gl_FragColor = vec4(high / 255.0, middle / 255.0, floor((depth - middle) * 256.0) / 255.0, 1.0);
    }`,
});

export class DepthPicker {
  constructor(viewport) {
    this.viewport = viewport;
  }

  /** Looks at `surface` again if the view has changed since the last time. */
  keepUp(surface) {
    const { camera, host } = this.viewport;
    camera.updateMatrixWorld();
    surface.updateWorldMatrix(true, false);
    const same =
      this.surface === surface &&
      this.width === host.clientWidth &&
      this.height === host.clientHeight &&
      this.camera.matrixWorld.equals(camera.matrixWorld) &&
      this.camera.projectionMatrix.equals(camera.projectionMatrix) &&
      this.stood.equals(surface.matrixWorld);
    if (!same) this.capture(surface);
  }

  /** Looks at `surface` (a three.js Mesh in the scene) as it stands now. */
  capture(surface) {
    const { renderer, camera, host } = this.viewport;
    const [width, height] = [host.clientWidth, host.clientHeight];
    const target = new WebGLRenderTarget(width, height, { minFilter: NearestFilter, magFilter: NearestFilter });
    const before = { alpha: renderer.getClearAlpha(), color: renderer.getClearColor(new Color()), used: surface.material };
    surface.material = material;
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear();
    renderer.render(surface, camera);
    this.pixels = new Uint8Array(4 * width * height);
    renderer.readRenderTargetPixels(target, 0, 0, width, height, this.pixels);
    renderer.setRenderTarget(null);
    renderer.setClearColor(before.color, before.alpha);
    surface.material = before.used;
    target.dispose();
    Object.assign(this, { width, height, surface, camera: camera.clone(false), stood: surface.matrixWorld.clone() });
  }

  /** The place on the surface under a pixel of the window, as [x, y, z] of the surface's own frame; null beside it. */
  at(x, y) {
    const [column, row] = [Math.floor(x), this.height - 1 - Math.floor(y)];
    if (column < 0 || row < 0 || column >= this.width || row >= this.height) return null;
    const depth = depthOf(this.pixels, 4 * (row * this.width + column));
    if (depth === null) return null;
    // The depth is that of the pixel's middle.
    const clip = new Vector3((2 * (column + 0.5)) / this.width - 1, (2 * (row + 0.5)) / this.height - 1, 2 * depth - 1);
    return this.surface.worldToLocal(clip.unproject(this.camera)).toArray();
  }
}

/** Depth from 0 to 1 that the four bytes say; null for nothing. */
function depthOf(pixels, k) {
  if (pixels[k + 3] === 0) return null;
  return pixels[k] / 2 ** 8 + pixels[k + 1] / 2 ** 16 + (pixels[k + 2] + 0.5) / 2 ** 24;
}
