// The hand: mouse, pen, fingers and keys say where it wants to be, or from where to look.

import * as THREE from 'three';
import type { Triple } from './messages';
import type { View } from './view';

const TURN_PER_PX = 0.006;
const NOTCH = 0.006; // of the distance: a step of a wheel or key
const KEY_TURN = 0.08;
const ZOOM = 1.12;
// By then the hand is where it was told to be, but for a long way.
const SETTLED_MS = 500;

export class Hand {
  /** When it was told last. */
  private told_ms = -Infinity;
  /** Where the hand was told to be; in a trace there is none. */
  target: THREE.Vector3 | undefined;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private spread = 0;

  constructor(
    private readonly view: View,
    private readonly tell: (target: Triple) => void,
  ) {
    const { canvas } = view;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) {
      canvas.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  /** Where the hand is: it goes on from there, unless it is on its way. */
  follow(at: Triple): void {
    if (performance.now() - this.told_ms > SETTLED_MS) this.target = new THREE.Vector3(...at);
  }

  private down(event: PointerEvent): void {
    this.view.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.spread = this.fingers();
    this.view.canvas.focus({ preventScroll: true });
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const right = event.clientX - before.x;
    const down = event.clientY - before.y;
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.pointers.size >= 2) {
      this.pinch(right, down);
    } else if (event.buttons & 4) {
      this.view.orbit.pan(right, -down, this.view.canvas.clientHeight);
      this.view.changed();
    } else if (event.buttons & 2 || event.shiftKey || !this.target) {
      this.turn(-right * TURN_PER_PX, down * TURN_PER_PX);
    } else {
      this.across(right, -down);
    }
  }

  private fingers(): number {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  /** Two fingers: turn, and zoom by the way between them. */
  private pinch(right: number, down: number): void {
    const spread = this.fingers();
    if (this.spread > 0 && spread > 0) this.zoom(this.spread / spread);
    this.spread = spread;
    this.turn(-0.5 * right * TURN_PER_PX, 0.5 * down * TURN_PER_PX);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    if (event.ctrlKey || event.metaKey || !this.target) {
      this.zoom(event.deltaY > 0 ? ZOOM : 1 / ZOOM);
    } else {
      this.along(event.deltaY > 0 ? -1 : 1);
    }
  }

  private key(event: KeyboardEvent): void {
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
    };
    const arrow = arrows[event.key];
    const step_px = 0.01 * this.view.canvas.clientHeight;
    if (arrow && event.shiftKey) this.turn(-arrow[0] * KEY_TURN, -arrow[1] * KEY_TURN);
    else if (arrow && this.target) this.across(arrow[0] * step_px, arrow[1] * step_px);
    else if (event.key === 'PageUp') this.along(1);
    else if (event.key === 'PageDown') this.along(-1);
    else if (event.key === '+' || event.key === '=') this.zoom(1 / ZOOM);
    else if (event.key === '-') this.zoom(ZOOM);
    else if (event.key === 'Home') this.reset();
    else return;
    event.preventDefault();
  }

  reset(): void {
    this.view.orbit.reset();
    this.view.changed();
  }
  private turn(yaw: number, pitch: number): void {
    this.view.orbit.turn(yaw, pitch);
    this.view.changed();
  }
  private zoom(factor: number): void {
    this.view.orbit.zoom(factor);
    this.view.changed();
  }

  /** In the plane of the view. */
  private across(right_px: number, up_px: number): void {
    if (!this.target) return;
    const { orbit, canvas } = this.view;
    const scale = orbit.metresPerPixel(this.target, canvas.clientHeight);
    this.target.addScaledVector(orbit.right, right_px * scale).addScaledVector(orbit.up, up_px * scale);
    this.say();
  }
  private say(): void {
    this.told_ms = performance.now();
    if (this.target) this.tell(this.target.toArray());
  }
  /** Along the view: positive goes away from the eye. */
  private along(notches: number): void {
    if (!this.target) return;
    const { orbit } = this.view;
    const far = this.target.distanceTo(orbit.camera.position);
    this.target.addScaledVector(orbit.forward, notches * NOTCH * far);
    this.say();
  }
}
