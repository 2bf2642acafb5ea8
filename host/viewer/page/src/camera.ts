// A camera that goes round a point. z is up, as in the device's frame; x comes to the user.

import * as THREE from 'three';

const START = { yaw: 0.5, pitch: 0.35 };
const STEEPEST = 1.55;

export class Orbit {
  readonly camera = new THREE.PerspectiveCamera(35, 1, 0.001, 100);
  private yaw = START.yaw;
  private pitch = START.pitch;
  private distance = 1;
  private readonly target = new THREE.Vector3();
  private fitted = new THREE.Sphere(new THREE.Vector3(), 0.1);

  /** Shows all of it. */
  fit(sphere: THREE.Sphere): void {
    this.fitted = sphere.clone();
    this.yaw = START.yaw;
    this.pitch = START.pitch;
    this.target.copy(sphere.center);
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    const narrow = Math.min(1, this.camera.aspect);
    this.distance = (1.05 * sphere.radius) / Math.sin(half) / narrow;
    this.place();
  }
  reset(): void {
    this.fit(this.fitted);
  }

  turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = THREE.MathUtils.clamp(this.pitch + pitch, -STEEPEST, STEEPEST);
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
  /** Where `at` is. */
  metresPerPixel(at: THREE.Vector3, height_px: number): number {
    const depth = at.clone().sub(this.camera.position).dot(this.forward);
    const half = Math.tan(THREE.MathUtils.degToRad(this.camera.fov / 2));
    return (2 * Math.max(depth, this.camera.near) * half) / height_px;
  }

  private place(): void {
    const level = Math.cos(this.pitch);
    const away = new THREE.Vector3(
      level * Math.cos(this.yaw), level * Math.sin(this.yaw), Math.sin(this.pitch),
    );
    this.camera.up.set(0, 0, 1);
    this.camera.position.copy(this.target).addScaledVector(away, this.distance);
    this.camera.lookAt(this.target);
    this.camera.near = Math.max(this.distance / 500, 1e-4);
    this.camera.far = this.distance + 40 * this.fitted.radius + 2;
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
  }
}
