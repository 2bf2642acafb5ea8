// Moves the simulated hand freely: in the plane of the view, along the line of sight, and back to its
// start. Presses on the surface are in touch.ts.

import * as THREE from 'three';
import type { Triple } from './messages';
import { routeTo } from './route';
import { type SendHand, Touch } from './touch';
import type { View } from './view';

const NOTCH = 0.006; // step of a key, as a share of the distance
// After this time without input the simulated hand has usually reached its target.
const SETTLED_MS = 500;
const GRAB_PX = 16;

export class Hand {
  readonly touch: Touch;
  private sent_ms = -Infinity;
  private target: THREE.Vector3 | undefined;
  private at = new THREE.Vector3();
  private start: THREE.Vector3 | undefined;

  constructor(
    private readonly view: View,
    private readonly send: SendHand,
  ) {
    this.touch = new Touch(view, (target, via, speed) => {
      this.sent_ms = performance.now();
      this.target = new THREE.Vector3(...target);
      this.send(target, via, speed);
    });
  }

  /** `start_m`: of the simulated hand; undefined where no hand can be moved (trace, board). */
  hello(start_m: Triple | undefined): void {
    this.target = undefined;
    this.touch.forget();
    this.start = start_m && new THREE.Vector3(...start_m);
  }

  /** The start has moved with the model. */
  setStart(start_m: Triple): void {
    this.start?.set(...start_m);
  }

  get isMovable(): boolean {
    return this.start !== undefined;
  }

  /** Takes over the position of the simulated hand, unless a target was sent just before. */
  follow(at: Triple): void {
    this.at.set(...at);
    this.touch.follow(this.at);
    if (performance.now() - this.sent_ms > SETTLED_MS) this.target = this.at.clone();
  }

  /** True at the pixels of the hand's marker. */
  isAt(x: number, y: number): boolean {
    return this.isMovable && this.view.pixelOf(this.at).distanceTo(new THREE.Vector2(x, y)) < GRAB_PX;
  }

  /** Moves the target in the plane of the view. */
  across(right_px: number, up_px: number): void {
    if (!this.target) return;
    const { orbit, canvas } = this.view;
    const scale = orbit.metresPerPixel(this.target, canvas.clientHeight);
    this.target.addScaledVector(orbit.right, right_px * scale).addScaledVector(orbit.up, up_px * scale);
    this.sendTarget();
  }
  /** Moves the target along the line of sight; positive is farther from the camera. */
  along(notches: number): void {
    if (!this.target) return;
    const { orbit } = this.view;
    const distance = this.target.distanceTo(orbit.camera.position);
    this.target.addScaledVector(orbit.forward, notches * NOTCH * distance);
    this.sendTarget();
  }
  /** Returns the hand to its start, around the models. */
  bringBack(): void {
    if (!this.start) return;
    this.touch.forget();
    this.target = this.start.clone();
    this.sent_ms = performance.now();
    const via = routeTo(this.view, this.at, this.start).map((place): Triple => place.toArray());
    this.send(this.start.toArray(), via);
  }

  private sendTarget(): void {
    this.touch.forget();
    this.sent_ms = performance.now();
    if (this.target) this.send(this.target.toArray(), []);
  }
}
