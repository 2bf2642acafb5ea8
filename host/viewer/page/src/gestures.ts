// Mouse, pen, fingers and keys on the picture: touch the object, move the hand, move the camera.

import type { Hand } from './hand';
import type { View } from './view';

const TURN_PER_PX = 0.006;
const KEY_TURN = 0.08;
const ZOOM = 1.12;
const DEPTH_PER_PX_M = 5e-5;
// A second finger that follows sooner belongs to a gesture for the camera.
const TOGETHER_MS = 250;

// A pinch on a trackpad arrives as turns of a wheel with Ctrl, by a few pixels each.
const PINCH_PX = 50;
const PINCH_GAIN = 10;
const PX_PER_NOTCH = 100;
const LINES_PER_NOTCH = 3;

/** How far a wheel was turned, positive down: a busy page gets several notches as one event, and a
 *  trackpad sends parts of one. */
function notches({ deltaY, deltaMode, ctrlKey }: WheelEvent): number {
  if (deltaMode === WheelEvent.DOM_DELTA_PAGE) return deltaY;
  if (deltaMode === WheelEvent.DOM_DELTA_LINE) return deltaY / LINES_PER_NOTCH;
  const pinched = ctrlKey && Math.abs(deltaY) < PINCH_PX;
  return (deltaY / PX_PER_NOTCH) * (pinched ? PINCH_GAIN : 1);
}

/** What a pressed button or finger moves. */
type Grip = 'surface' | 'depth' | 'hand' | 'handle' | 'turn' | 'pan' | 'roll' | 'camera' | 'nothing';

interface Pointer {
  x: number;
  y: number;
  grip: Grip;
  since_ms: number;
}

export class Gestures {
  private readonly pointers = new Map<number, Pointer>();

  constructor(
    private readonly view: View,
    private readonly hand: Hand,
    /** True: a handle of the model has just taken the pointer. */
    private readonly isTaken: () => boolean,
  ) {
    const { canvas } = view;
    canvas.addEventListener('pointerdown', (event) => this.down(event));
    canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture'] as const) {
      canvas.addEventListener(end, (event) => this.up(event));
    }
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  private down(event: PointerEvent): void {
    if (this.pointers.has(event.pointerId)) return; // a second button
    this.view.canvas.setPointerCapture(event.pointerId);
    this.view.canvas.focus({ preventScroll: true });
    const [first] = this.pointers.values();
    const grip = first ? this.secondGrip(first, event) : this.firstGrip(event);
    this.pointers.set(event.pointerId, { ...this.pixel(event), grip, since_ms: event.timeStamp });
  }

  private firstGrip(event: PointerEvent): Grip {
    if (this.isTaken()) return 'handle';
    if (event.button === 1 || event.shiftKey) return 'pan';
    if (event.ctrlKey) return 'roll';
    const at = this.pixel(event);
    if (event.button !== 0 || !this.hand.isMovable) return 'turn';
    if (this.hand.touch.begin(at)) return 'surface';
    return this.hand.isAt(at.x, at.y) ? 'hand' : 'turn';
  }

  // The times of the events, not of their handling: a busy page handles them late.
  private secondGrip(first: Pointer, event: PointerEvent): Grip {
    if (this.pointers.size > 1 || first.grip === 'handle') return 'nothing';
    if (first.grip === 'surface' && event.timeStamp - first.since_ms > TOGETHER_MS) return 'depth';
    this.hand.touch.end();
    first.grip = 'camera';
    return 'camera';
  }

  private move(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const before = { x: pointer.x, y: pointer.y };
    const others = this.spread();
    Object.assign(pointer, this.pixel(event));
    const right = pointer.x - before.x;
    const down = pointer.y - before.y;
    const { height } = this.view.canvas.getBoundingClientRect();
    if (pointer.grip === 'surface') this.hand.touch.drag(pointer);
    else if (pointer.grip === 'depth') this.hand.touch.deepenBy(-down * DEPTH_PER_PX_M);
    else if (pointer.grip === 'hand') this.hand.across(right, -down);
    else if (pointer.grip === 'turn') this.turn(-right * TURN_PER_PX, down * TURN_PER_PX);
    else if (pointer.grip === 'roll') this.roll(right * TURN_PER_PX);
    else if (pointer.grip === 'pan') this.pan(right, -down, height);
    else if (pointer.grip === 'camera') this.moveCamera(right, down, others, height);
  }

  /** Two fingers: they pan, their distance zooms, their direction rolls. */
  private moveCamera(right: number, down: number, before: Spread, height: number): void {
    const now = this.spread();
    this.pan(right / 2, -down / 2, height);
    if (before.distance > 0 && now.distance > 0) this.zoom(before.distance / now.distance);
    const turned = now.angle - before.angle;
    this.roll(Math.atan2(Math.sin(turned), Math.cos(turned)));
  }

  private spread(): Spread {
    const [a, b] = this.pointers.values();
    if (!a || !b) return { distance: 0, angle: 0 };
    return { distance: Math.hypot(b.x - a.x, b.y - a.y), angle: Math.atan2(b.y - a.y, b.x - a.x) };
  }

  private up(event: PointerEvent): void {
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    this.pointers.delete(event.pointerId);
    if (pointer.grip === 'surface') this.hand.touch.end();
    // The finger that remains of two does nothing.
    if (pointer.grip !== 'depth') for (const other of this.pointers.values()) other.grip = 'nothing';
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const { touch } = this.hand;
    const down = notches(event);
    if (touch.pressed && !event.ctrlKey && !event.metaKey) touch.deepen(-down);
    else this.zoom(ZOOM ** down);
  }

  private key(event: KeyboardEvent): void {
    const arrows: Record<string, [number, number]> = {
      ArrowLeft: [-1, 0],
      ArrowRight: [1, 0],
      ArrowUp: [0, 1],
      ArrowDown: [0, -1],
    };
    const others: Record<string, () => void> = {
      PageUp: () => this.hand.along(1),
      PageDown: () => this.hand.along(-1),
      '+': () => this.zoom(1 / ZOOM),
      '=': () => this.zoom(1 / ZOOM),
      '-': () => this.zoom(ZOOM),
      '[': () => this.roll(-KEY_TURN),
      ']': () => this.roll(KEY_TURN),
      Home: () => this.reset(),
      Backspace: () => this.hand.bringBack(),
    };
    const arrow = arrows[event.key];
    if (arrow) this.arrow(event, ...arrow);
    else if (others[event.key]) others[event.key]();
    else return;
    event.preventDefault();
  }

  private arrow(event: KeyboardEvent, right: number, up: number): void {
    const height = this.view.canvas.clientHeight;
    const step_px = 0.01 * height;
    if (event.ctrlKey) this.pan(-4 * right * step_px, -4 * up * step_px, height);
    else if (event.shiftKey) this.turn(-right * KEY_TURN, -up * KEY_TURN);
    else this.hand.across(right * step_px, up * step_px);
  }

  reset(): void {
    this.view.showAll();
    this.moved();
  }
  private turn(yaw: number, pitch: number): void {
    this.view.orbit.turn(yaw, pitch);
    this.moved();
  }
  private roll(angle: number): void {
    this.view.orbit.roll(angle);
    this.moved();
  }
  private pan(right_px: number, up_px: number, height_px: number): void {
    this.view.orbit.pan(right_px, up_px, height_px);
    this.moved();
  }
  private zoom(factor: number): void {
    this.view.orbit.zoom(factor);
    this.moved();
  }
  private moved(): void {
    this.view.changed();
    this.hand.touch.refresh();
  }

  private pixel(event: PointerEvent): { x: number; y: number } {
    const box = this.view.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }
}

interface Spread {
  distance: number;
  angle: number;
}
