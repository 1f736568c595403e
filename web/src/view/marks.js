// Small balls at places to look at; they are seen through everything.
import { Group, Mesh, MeshBasicMaterial, SphereGeometry } from "three";
import { themeColor } from "./theme.js";

const SIZE = 0.024; // of the shape's radius

export class Marks {
  group = new Group();

  /** @param points [x, y, z] each; none takes all away  @param radius of the shape */
  show(points, radius) {
    this.dispose();
    if (points.length === 0) return;
    this.geometry = new SphereGeometry(radius * SIZE, 20, 12);
    this.material = new MeshBasicMaterial({ color: themeColor("--bad"), depthTest: false, transparent: true });
    for (const point of points) {
      const ball = new Mesh(this.geometry, this.material);
      ball.position.set(...point);
      ball.renderOrder = 10;
      this.group.add(ball);
    }
  }

  recolor() {
    this.material?.color.set(themeColor("--bad"));
  }

  dispose() {
    this.group.clear();
    this.geometry?.dispose();
    this.material?.dispose();
  }
}
