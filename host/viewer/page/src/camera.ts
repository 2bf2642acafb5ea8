// A camera on an orbit around a point. At first it looks at the front of the model, the side of +x,
// slightly from above: z is up and x points to the user, as in the device frame, so that y is to the
// right in the picture and at the device. Every orientation can be reached.

import * as THREE from 'three';

const START = { yaw: 0, pitch: 0.35 };
const Z = new THREE.Vector3(0, 0, 1);

export class Orbit {
  readonly camera = new THREE.PerspectiveCamera(35, 1, 0.001, 100);
  private distance = 1;
  private readonly target = new THREE.Vector3();
  private fitted = new THREE.Sphere(new THREE.Vector3(), 0.1);

  /** Places the camera so that the whole sphere is visible. */
  fit(sphere: THREE.Sphere): void {
    this.fitted = sphere.clone();
    const level = Math.cos(START.pitch);
    const from = new THREE.Vector3(
      level * Math.cos(START.yaw),
      level * Math.sin(START.yaw),
      Math.sin(START.pitch),
    );
    this.camera.quaternion.setFromRotationMatrix(new THREE.Matrix4().lookAt(from, new THREE.Vector3(), Z));
    this.target.copy(sphere.center);
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.min(1, this.camera.aspect);
    this.distance = (1.05 * sphere.radius) / Math.sin(half) / narrow;
    this.place();
  }

  /** Turns the camera around the scene's vertical, and over the scene. */
  turn(yaw: number, pitch: number): void {
    const upright = this.up.z < 0 ? -1 : 1;
    this.camera.quaternion.premultiply(new THREE.Quaternion().setFromAxisAngle(Z, upright * yaw));
    this.camera.rotateX(-pitch);
    this.place();
  }
  /** Turns the camera around its line of sight. */
  roll(angle: number): void {
    this.camera.rotateZ(angle);
    this.place();
  }
  zoom(factor: number): void {
    const { radius } = this.fitted;
    this.distance = THREE.MathUtils.clamp(this.distance * factor, 0.05 * radius, 30 * radius);
    this.place();
  }
  pan(right_px: number, up_px: number, height_px: number): void {
    this.target.addScaledVector(this.right, -right_px * this.metresPerPixel(this.target, height_px));
    this.target.addScaledVector(this.up, -up_px * this.metresPerPixel(this.target, height_px));
    this.place();
  }
  resize(width: number, height: number): void {
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  get right(): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
  }
  get up(): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 1);
  }
  get forward(): THREE.Vector3 {
    return new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 2).negate();
  }
  /** Size of a pixel at the depth of `at`. */
  metresPerPixel(at: THREE.Vector3, height_px: number): number {
    const depth = at.clone().sub(this.camera.position).dot(this.forward);
    const half = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    return (2 * Math.max(depth, this.camera.near) * half) / height_px;
  }

  private place(): void {
    const offset = Z.clone().applyQuaternion(this.camera.quaternion);
    this.camera.position.copy(this.target).addScaledVector(offset, this.distance);
    this.camera.near = Math.max(this.distance / 500, 1e-4);
    this.camera.far = this.distance + 40 * this.fitted.radius + 2;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}
