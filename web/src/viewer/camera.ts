// The camera: parallel projection, turned about a target, z upwards.

import { OrthographicCamera, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { StandardView } from "./types";

const FROM: Readonly<Record<StandardView, readonly [number, number, number]>> = {
  iso: [0.62, -0.88, 0.72], top: [0, -1e-4, 1], bottom: [0, -1e-4, -1], front: [0, -1, 0], back: [0, 1, 0], left: [-1, 0, 0], right: [1, 0, 0],
};
const MARGIN = 1.12;

export class Camera {
  readonly eye = new OrthographicCamera();
  readonly controls: OrbitControls;
  private size = 1;
  private aspect = 1;

  constructor(canvas: HTMLElement, changed: () => void) {
    this.eye.up.set(0, 0, 1);
    this.eye.position.set(...FROM.iso);
    this.controls = new OrbitControls(this.eye, canvas);
    this.controls.zoomToCursor = true;
    this.controls.zoomSpeed = 1.4;
    this.controls.addEventListener("change", changed);
  }

  /** The size of what is looked at [m]: distances and depths follow it. */
  scale(size: number): void {
    this.size = size;
    this.controls.minZoom = 0.2;
    this.controls.maxZoom = 400;
    this.frame();
  }

  resize(aspect: number): void {
    this.aspect = aspect;
    this.frame();
  }

  private frame(): void {
    const half = 0.5 * this.size;
    this.eye.top = half;
    this.eye.bottom = -half;
    this.eye.left = -half * this.aspect;
    this.eye.right = half * this.aspect;
    this.eye.near = 0.01 * this.size;
    this.eye.far = 8 * this.size;
    this.eye.updateProjectionMatrix();
  }

  look(view: StandardView): void {
    const direction = new Vector3(...FROM[view]).normalize();
    this.place(direction);
  }

  /** Shows all of the points (3 a point) as large as they fit. */
  fit(points: Float32Array): void {
    if (points.length === 0) return;
    const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate(), point = new Vector3();
    const turn = this.eye.quaternion.clone().invert();
    for (let at = 0; at < points.length; at += 3) {
      point.fromArray(points, at).applyQuaternion(turn);
      low.min(point);
      high.max(point);
    }
    const middle = low.clone().add(high).multiplyScalar(0.5).applyQuaternion(this.eye.quaternion);
    const extent = high.sub(low);
    const direction = this.eye.position.clone().sub(this.controls.target).normalize();
    this.controls.target.copy(middle);
    const room = Math.max(extent.y, extent.x / this.aspect, 1e-6 * this.size);
    this.eye.zoom = Math.min(400, this.size / (MARGIN * room));
    this.place(direction);
  }

  private place(direction: Vector3): void {
    this.eye.position.copy(this.controls.target).addScaledVector(direction, 3 * this.size);
    this.eye.lookAt(this.controls.target);
    this.eye.updateProjectionMatrix();
    this.controls.update();
    this.eye.updateMatrixWorld();
  }

  /** Where a point is seen, from the upper left corner, as shares of width and height. */
  project(point: Vector3): [number, number] {
    const seen = point.clone().project(this.eye);
    return [0.5 * (1 + seen.x), 0.5 * (1 - seen.y)];
  }

  /** Metres a pixel of a picture of that height. */
  metresPerPixel(height: number): number {
    return this.size / this.eye.zoom / height;
  }

  dispose(): void {
    this.controls.dispose();
  }
}
