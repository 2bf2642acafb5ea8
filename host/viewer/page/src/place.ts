// Places the model in the reach of the device: by handles in the picture, or by numbers. The frame of
// the device has x to the user, y to the right and z up.

import * as THREE from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import type { Command, Frame, Place, Placement, Triple } from './messages';
import { find } from './panel';
import { Reach } from './reach';
import type { View } from './view';

type Mode = 'translate' | 'rotate' | 'scale';
const AXES = ['x', 'y', 'z'] as const;
const FIELDS = [...AXES, ...AXES.map((axis) => `turn-${axis}`), 'size'];
// First about x, then y, then z.
const ORDER = 'ZYX';
const SMALLEST = 0.05; // change of the size by one drag
const LARGEST = 20;
const SAME_SCALE = 1e-4;
const SAME_POSE = 1e-6;
const SAME_ANGLE = 2e-4; // rad: of fields with two digits of a degree
// A pose that the server has not taken by then was lost or refused.
const PATIENCE_MS = 3000;

const input = (name: string): HTMLInputElement => find<HTMLInputElement>(`place-${name}`);
const field = (name: string): number => Number(input(name).value);

function isWrong(name: string): boolean {
  const { value, validity } = input(name);
  return value === '' || validity.badInput || validity.rangeUnderflow;
}

function turnOfFields(): THREE.Quaternion {
  const [x, y, z] = AXES.map((axis) => THREE.MathUtils.degToRad(field(`turn-${axis}`)));
  return new THREE.Quaternion().setFromEuler(new THREE.Euler(x, y, z, ORDER));
}

/** Reads a pose: a matrix, row by row. */
function matrixOf(rows: number[]): THREE.Matrix4 {
  return new THREE.Matrix4().fromArray(rows).transpose();
}

/** The content of a pose file. */
function textOf({ pose, scale }: Placement): string {
  const rows = [0, 4, 8, 12].map((at) => pose.slice(at, at + 4).map((v) => Number(v.toPrecision(9))));
  return `{"pose": [${rows.map((row) => row.join(', ')).join(',\n          ')}],\n "scale": ${scale}}\n`;
}

export class PlaceView {
  private readonly box = find<HTMLDetailsElement>('place');
  private readonly handle = new THREE.Object3D();
  private readonly controls: TransformControls;
  private readonly reach = new Reach();
  private device = '';
  private now: Place | undefined;
  private hasBoard = false;
  private sent: { pose: number[]; until_ms: number } | undefined;
  private asked: Placement | undefined; // until a restart is confirmed

  constructor(
    private readonly view: View,
    private readonly say: (command: Command) => void,
    private readonly complain: (text: string) => void,
  ) {
    this.controls = new TransformControls(view.orbit.camera, view.canvas);
    this.controls.enabled = false;
    this.controls.addEventListener('change', () => view.changed());
    this.controls.addEventListener('objectChange', () => this.dragged());
    this.controls.addEventListener('mouseUp', () => this.send());
    view.add(this.handle);
    view.add(this.controls.getHelper());
    view.add(this.reach.group);
    this.controls.attach(this.handle);
    this.controls.getHelper().visible = false;
    this.box.addEventListener('toggle', () => this.opened());
    for (const mode of ['translate', 'rotate', 'scale'] as Mode[]) {
      input(mode).addEventListener('change', () => this.controls.setMode(mode));
    }
    for (const name of FIELDS) input(name).addEventListener('change', () => this.typed());
    find('place-reset').addEventListener('click', () => this.reset());
    find('place-save').addEventListener('click', () => this.save());
    find('place-restart').addEventListener('click', () => this.confirm());
    find('place-cancel').addEventListener('click', () => this.release());
  }

  /** True while a pointer holds a handle. */
  get isHeld(): boolean {
    return this.controls.dragging;
  }

  /** Another session has begun, or the server refused a pose: shows what it says. */
  release(): void {
    this.sent = undefined;
    this.asked = undefined;
    find('place-ask').hidden = true;
    this.view.hold(undefined);
    if (this.now) this.follow(this.now);
  }

  show(frame: Frame): void {
    this.now = frame.place;
    this.box.hidden = !frame.place;
    if (!frame.place) return;
    this.hasBoard = frame.board !== undefined;
    input('size').disabled = this.hasBoard;
    input('scale').disabled = this.hasBoard;
    this.reach.group.position.set(...frame.place.origin_m).negate();
    this.showHandles();
    this.loadReach(frame.settings?.device ?? '-');
    if (this.sent && this.isDone(frame.place, this.sent)) this.release();
    const isFree = !this.isHeld && !this.sent && !this.asked;
    if (isFree) this.follow(frame.place);
  }

  private isDone(place: Place, sent: { pose: number[]; until_ms: number }): boolean {
    const off = Math.max(...place.pose.map((value, i) => Math.abs(value - sent.pose[i])));
    return off < SAME_POSE || performance.now() > sent.until_ms;
  }

  /** Handles in one of two pictures would not follow the pointer. */
  private showHandles(): void {
    const isUsable = this.box.open && this.view.sides === 1;
    this.controls.enabled = isUsable;
    this.controls.getHelper().visible = isUsable;
    find('place-sides').hidden = this.view.sides === 1;
  }

  private opened(): void {
    this.reach.group.visible = this.box.open;
    find('legend-reach').hidden = !this.box.open;
    this.showHandles();
    if (!this.box.open) this.release();
    this.view.changed();
  }

  private loadReach(device: string): void {
    if (!this.box.open || this.device === device) return;
    this.device = device;
    this.reach
      .load()
      .then(() => this.view.changed())
      .catch((error: Error) => this.complain(error.message));
  }

  /** Puts handles and numbers where the model is. */
  private follow(place: Place): void {
    const pose = matrixOf(place.pose);
    this.handle.position.copy(this.view.centre).applyMatrix4(pose).sub(this.originOf(place));
    this.handle.quaternion.setFromRotationMatrix(pose);
    this.handle.scale.setScalar(1);
    this.showNumbers();
  }
  private originOf(place: Place): THREE.Vector3 {
    return new THREE.Vector3(...place.origin_m);
  }

  private showNumbers(): void {
    if (!this.now) return;
    const at = this.handle.position.clone().add(this.originOf(this.now));
    for (const axis of AXES) setField(axis, 1e3 * at[axis], 2);
    this.showTurn();
    setField('size', 100 * this.now.scale * this.handle.scale.x, 2);
  }

  /** Other angles may tell the same turn: those that the user has typed stay. */
  private showTurn(): void {
    const { quaternion } = this.handle;
    const isShown = AXES.every((axis) => input(`turn-${axis}`).value !== '');
    if (isShown && turnOfFields().angleTo(quaternion) < SAME_ANGLE) return;
    const turn = new THREE.Euler().setFromQuaternion(quaternion, ORDER);
    for (const axis of AXES) setField(`turn-${axis}`, THREE.MathUtils.radToDeg(turn[axis]), 2);
  }

  private dragged(): void {
    if (this.controls.mode === 'scale') {
      // Alike along all axes: as along the one that was dragged.
      const [factor] = this.handle.scale.toArray().sort((a, b) => Math.abs(b - 1) - Math.abs(a - 1));
      this.handle.scale.setScalar(THREE.MathUtils.clamp(Math.abs(factor), SMALLEST, LARGEST));
    }
    this.preview();
    this.showNumbers();
  }

  private typed(): void {
    if (!this.now) return;
    const place: Triple = [field('x'), field('y'), field('z')];
    const scale = field('size') / 100 / this.now.scale;
    const wrong = FIELDS.find(isWrong);
    if (wrong) {
      this.complain(wrong === 'size' ? 'Size: a percentage above 0.1' : `${wrong}: a number`);
      this.release();
      return;
    }
    this.handle.position
      .set(...place)
      .multiplyScalar(1e-3)
      .sub(this.originOf(this.now));
    this.handle.quaternion.copy(turnOfFields());
    this.handle.scale.setScalar(scale);
    this.preview();
    this.send();
  }

  private reset(): void {
    for (const axis of AXES) {
      input(axis).value = '0';
      input(`turn-${axis}`).value = '0';
    }
    if (!this.hasBoard) input('size').value = '100';
    this.typed();
  }

  /** Of the model's origin at the handle, in the frame of the scene. */
  private get corner(): THREE.Vector3 {
    const { position, quaternion, scale } = this.handle;
    const centre = this.view.centre.multiplyScalar(scale.x).applyQuaternion(quaternion);
    return position.clone().sub(centre);
  }
  private preview(): void {
    const { quaternion, scale } = this.handle;
    this.view.hold(new THREE.Matrix4().compose(this.corner, quaternion, scale));
  }

  private send(): void {
    if (!this.now) return;
    const at = this.corner.add(this.originOf(this.now));
    const one = new THREE.Vector3(1, 1, 1);
    const matrix = new THREE.Matrix4().compose(at, this.handle.quaternion, one);
    const pose = matrix.transpose().toArray();
    const factor = this.handle.scale.x;
    if (Math.abs(factor - 1) < SAME_SCALE) {
      this.sent = { pose, until_ms: performance.now() + PATIENCE_MS };
      this.say({ do: 'place', pose, scale: this.now.scale });
      return;
    }
    this.asked = { pose, scale: this.now.scale * factor };
    find('place-ask-text').textContent =
      `Size ${(100 * this.asked.scale).toFixed(1)} %: the simulation restarts, and its recorded ticks are lost.`;
    find('place-ask').hidden = false;
  }

  private confirm(): void {
    if (!this.asked) return;
    this.say({ do: 'place', ...this.asked, restart: true });
    find('place-ask').hidden = true;
  }

  private save(): void {
    if (!this.now) return;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([textOf(this.now)], { type: 'application/json' }));
    link.download = 'pose.json';
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }
}

/** Not while the user types there. */
function setField(name: string, value: number, digits: number): void {
  const element = input(name);
  const text = String(Number(value.toFixed(digits)) || 0);
  if (document.activeElement !== element && element.value !== text) element.value = text;
}
