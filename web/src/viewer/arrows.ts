// Arrows of a twist at a point: one for the translation, a double-headed one along the axis of the rotation.

import { BufferGeometry, ConeGeometry, CylinderGeometry, GLSL3, Group, Mesh, RawShaderMaterial, Vector3 } from "three";
import { plainFragment, plainVertex } from "./shaders";
import type { Colour } from "./types";

const UP = new Vector3(0, 1, 0);

class Arrow {
  readonly group = new Group();
  private readonly material: RawShaderMaterial;
  private readonly shapes: BufferGeometry[] = [];

  constructor(heads: number) {
    this.material = new RawShaderMaterial({
      vertexShader: plainVertex, fragmentShader: plainFragment, glslVersion: GLSL3, uniforms: { tint: { value: [0, 0, 0] } }, depthTest: false, transparent: true,
    });
    this.add(new CylinderGeometry(0.018, 0.018, 0.78, 12).translate(0, 0.39, 0));
    for (let head = 0; head < heads; head++) this.add(new ConeGeometry(0.06, 0.22, 16).translate(0, 0.89 - 0.16 * head, 0));
    this.group.visible = false;
  }

  private add(shape: BufferGeometry): void {
    const mesh = new Mesh(shape, this.material);
    mesh.renderOrder = 9;
    mesh.frustumCulled = false;
    this.shapes.push(shape);
    this.group.add(mesh);
  }

  point(from: Vector3, along: Vector3, length: number): void {
    this.group.visible = length > 0 && along.lengthSq() > 0;
    if (!this.group.visible) return;
    this.group.position.copy(from);
    this.group.quaternion.setFromUnitVectors(UP, along.clone().normalize());
    this.group.scale.setScalar(length);
  }

  set tint(colour: Colour) {
    this.material.uniforms["tint"]!.value = colour;
  }

  dispose(): void {
    this.material.dispose();
    for (const each of this.shapes) each.dispose();
  }
}

export class TwistArrows {
  readonly group = new Group();
  private readonly translation = new Arrow(1);
  private readonly rotation = new Arrow(2);

  constructor() {
    this.group.add(this.translation.group, this.rotation.group);
  }

  tint(translation: Colour, rotation: Colour): void {
    this.translation.tint = translation;
    this.rotation.tint = rotation;
  }

  /** A twist (at the origin) told at a point; lengths are shares of `size` by what moves most, a turn counted at an arm of size / 4. */
  show(twist: ArrayLike<number> | null, point: Vector3, size: number, sense: number): void {
    if (twist === null) {
      this.translation.group.visible = this.rotation.group.visible = false;
      return;
    }
    const turn = new Vector3(twist[3], twist[4], twist[5]);
    const shift = new Vector3(twist[0], twist[1], twist[2]).add(turn.clone().cross(point));
    const sizes = [shift.length(), 0.25 * size * turn.length()] as const;
    const most = Math.max(...sizes);
    const length = (share: number): number => (most > 0 && share > 0.02 * most ? 0.3 * size * (share / most) * Math.abs(sense) : 0);
    this.translation.point(point, shift.multiplyScalar(Math.sign(sense)), length(sizes[0]));
    this.rotation.point(point, turn.multiplyScalar(Math.sign(sense)), length(sizes[1]));
  }

  dispose(): void {
    this.translation.dispose();
    this.rotation.dispose();
  }
}
