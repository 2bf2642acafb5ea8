// Presses the simulated hand onto the surface under the cursor: there along the line of sight, in by
// a depth, along the surface with the cursor, and back when the cursor is released.

import * as THREE from 'three';
import type { Triple } from './messages';
import { routeTo } from './route';
import type { Place } from './search';
import type { View } from './view';

/** Sends the hand to a target, through places on its path; the speed is optional. */
export type SendHand = (target_m: Triple, via_m: Triple[], speed_m_s?: number) => void;

const DEPTH_M = 0.004;
const DEEPEST_M = 0.04;
const NOTCH_M = 0.001;
// The hand waits this far from the surface before and after a touch, relative to the model.
const CLEARANCE = 0.1;
const MAX_CLEARANCE_M = 0.03;
// Between two places of the surface that are farther apart the hand is lifted.
const JUMP = 0.12;
const LAND_M_S = 0.08;
// A faster hand is thrown off a small round model.
const SLIDE_M_S = 0.2;
const SAMPLE_PX = 8;
const MAX_SAMPLES = 12;
// Each with two places above it: fewer than the server accepts.
const MAX_TRAIL = 20;
const REACHED_M = 0.001;

interface Pressed extends Place {
  toward: THREE.Vector3; // the viewer, of unit length
  jump: boolean; // from the place before
}

interface Pixel {
  x: number;
  y: number;
}

export class Touch {
  /** Depth of the hand below the surface, m. */
  depth_m = DEPTH_M;
  private cursor: Pixel | undefined;
  private hand = new THREE.Vector3();
  // Places under the cursor that the hand has not passed yet; the last is the present one.
  private trail: Pressed[] = [];
  // There, down to the surface, along it.
  private phase: 'approach' | 'landing' | 'sliding' = 'approach';

  constructor(
    private readonly view: View,
    private readonly send: SendHand,
  ) {}

  get pressed(): boolean {
    return this.cursor !== undefined;
  }

  /** Presses on the surface at this pixel of the view. False: there is none. */
  begin(at: Pixel): boolean {
    const place = this.placeAt(at);
    if (!place) return false;
    this.cursor = at;
    this.depth_m = Math.min(DEPTH_M, 0.08 * this.view.size);
    this.trail = [place];
    this.phase = 'approach';
    this.sendTrail();
    return true;
  }

  drag(to: Pixel): void {
    if (!this.cursor) return;
    const from = this.cursor;
    this.cursor = to;
    if (this.phase === 'approach') {
      const place = this.placeAt(to);
      if (!place) return;
      this.trail = [place];
    } else {
      this.extend(from, to);
    }
    this.sendTrail();
  }

  deepen(notches: number): void {
    this.deepenBy(notches * NOTCH_M);
  }
  deepenBy(metres: number): void {
    this.depth_m = THREE.MathUtils.clamp(this.depth_m + metres, 0, DEEPEST_M);
    if (this.pressed) this.sendTrail();
  }

  /** Withdraws the hand toward the viewer. */
  end(): void {
    const [place] = this.trail;
    if (!this.cursor || !place) return;
    const goal = this.above(place);
    this.forget();
    const isApproaching = this.phase === 'approach';
    this.send(goal.toArray(), isApproaching ? triples(routeTo(this.view, this.hand, goal)) : []);
  }

  /** The hand was moved by other means. */
  forget(): void {
    this.cursor = undefined;
    this.trail = [];
  }

  /** Takes over the position of the simulated hand. */
  follow(at: THREE.Vector3): void {
    this.hand.copy(at);
    const [first] = this.trail;
    if (!first) return;
    const near = Math.max(REACHED_M, 0.01 * this.view.size);
    if (this.phase === 'approach') {
      if (this.above(first).distanceTo(at) > near) return;
      this.phase = 'landing';
      this.sendTrail();
      return;
    }
    for (let i = this.trail.length - 1; i >= 0; --i) {
      if (this.target(this.trail[i]).distanceTo(at) > near) continue;
      this.phase = 'sliding';
      this.trail.splice(0, i);
      return;
    }
  }

  /** The surface moved, or the camera: looks again under the cursor. */
  refresh(): void {
    if (this.cursor) this.drag(this.cursor);
  }

  private placeAt(at: Pixel): Pressed | undefined {
    const ray = this.view.rayAt(at.x, at.y);
    const hit = this.view.hit(ray);
    return hit && { ...hit, toward: ray.direction.clone().negate(), jump: false };
  }

  /** Adds the places under the cursor's path, so that the hand slides over all of them. */
  private extend(from: Pixel, to: Pixel): void {
    const length = Math.hypot(to.x - from.x, to.y - from.y);
    const count = Math.min(MAX_SAMPLES, Math.max(1, Math.ceil(length / SAMPLE_PX)));
    let gap = false;
    for (let i = 1; i <= count; ++i) {
      const place = this.placeAt({
        x: from.x + ((to.x - from.x) * i) / count,
        y: from.y + ((to.y - from.y) * i) / count,
      });
      if (!place) {
        gap = true;
        continue;
      }
      const last = this.trail[this.trail.length - 1];
      place.jump = gap || (last !== undefined && last.point.distanceTo(place.point) > JUMP * this.view.size);
      this.trail.push(place);
      gap = false;
    }
    this.thin();
  }

  private thin(): void {
    if (this.trail.length <= MAX_TRAIL) return;
    const last = this.trail.length - 1;
    this.trail = this.trail.filter((place, i) => i === 0 || i === last || place.jump || i % 2 === 1);
    if (this.trail.length > MAX_TRAIL) this.trail.splice(1, this.trail.length - MAX_TRAIL);
  }

  private target(place: Pressed): THREE.Vector3 {
    return place.point.clone().addScaledVector(place.normal, -this.depth_m);
  }
  private above(place: Pressed): THREE.Vector3 {
    const clearance = Math.min(CLEARANCE * this.view.size, MAX_CLEARANCE_M);
    return place.point.clone().addScaledVector(place.toward, clearance);
  }

  private sendTrail(): void {
    const [first] = this.trail;
    if (!first) return;
    if (this.phase === 'approach') {
      const start = this.above(first);
      this.send(start.toArray(), triples(routeTo(this.view, this.hand, start)));
      return;
    }
    const via: THREE.Vector3[] = [];
    // The hand has passed the first place when it slides.
    const next = this.phase === 'sliding' && this.trail.length > 1 ? 1 : 0;
    for (let i = next; i < this.trail.length; ++i) {
      const place = this.trail[i];
      if (i > 0 && place.jump) via.push(this.above(this.trail[i - 1]), this.above(place));
      via.push(this.target(place));
    }
    const target = via.pop();
    if (target) this.send(target.toArray(), triples(via), this.phase === 'landing' ? LAND_M_S : SLIDE_M_S);
  }
}

const triples = (places: THREE.Vector3[]): Triple[] => places.map((place) => place.toArray());
