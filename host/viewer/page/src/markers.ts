// Markers of one controller and its device: linkage, probe, proxy, force, contact points.

import * as THREE from 'three';
import { length, type Run, type Triple } from './messages';
import type { Nearest } from './search';
import { Shadow } from './shadow';

export const COLOURS = {
  hand: 0x8b6fd6,
  probe: 0xe07a3f,
  proxy: 0x1aa398,
  force: 0xd9480f,
  patch: 0xe0a526,
  device: 0x7f8c9a,
};

// Length of the arrow at the largest force, relative to the size of the model.
const ARROW = 0.4;
const MAX_CANDIDATES = 128;

const UP = new THREE.Vector3(0, 1, 0);

/** Stretches an object of unit length from one point to another. */
function stretch(object: THREE.Object3D, from: THREE.Vector3, to: THREE.Vector3, width: number): void {
  const offset = to.clone().sub(from);
  const length_m = offset.length();
  object.visible = length_m > 1e-6;
  if (!object.visible) return;
  object.position.copy(from).addScaledVector(offset, 0.5);
  object.quaternion.setFromUnitVectors(UP, offset.divideScalar(length_m));
  object.scale.set(width, length_m, width);
}

export class Markers {
  readonly group = new THREE.Group();
  private readonly device = new THREE.Group();
  private readonly probe: THREE.Mesh;
  private readonly proxy: THREE.Mesh;
  private readonly spring: THREE.Mesh;
  private readonly arrow = new THREE.Group();
  private readonly shaft: THREE.Mesh;
  private readonly head: THREE.Mesh;
  private readonly patch: THREE.Points;
  private readonly shadow: Shadow;
  private readonly rod = new THREE.CylinderGeometry(1, 1, 1, 12);
  private readonly ball = new THREE.SphereGeometry(1, 24, 16);
  private readonly metal = new THREE.MeshStandardMaterial({
    color: COLOURS.device,
    roughness: 0.55,
    metalness: 0.2,
  });

  /** `size`: of the model, m. */
  constructor(private size: number) {
    const mesh = (geometry: THREE.BufferGeometry, color: number, opacity = 1) =>
      new THREE.Mesh(
        geometry,
        new THREE.MeshStandardMaterial({ color, roughness: 0.4, transparent: opacity < 1, opacity }),
      );
    this.probe = mesh(this.ball, COLOURS.probe);
    this.proxy = mesh(this.ball, COLOURS.proxy, 0.85);
    this.spring = mesh(this.rod, COLOURS.proxy);
    this.shaft = mesh(this.rod, COLOURS.force);
    this.head = mesh(new THREE.ConeGeometry(1, 1, 16), COLOURS.force);
    this.arrow.add(this.shaft, this.head);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * MAX_CANDIDATES), 3));
    this.patch = new THREE.Points(
      geometry,
      new THREE.PointsMaterial({ color: COLOURS.patch, size: 5, sizeAttenuation: false, depthTest: false }),
    );
    this.patch.frustumCulled = false;
    this.patch.renderOrder = 1;
    // The probe is inside the object during contact and must stay visible.
    for (const object of [this.probe, this.spring, this.shaft, this.head]) {
      (object.material as THREE.Material).depthTest = false;
      object.renderOrder = 2;
    }
    this.shadow = new Shadow(size, COLOURS.probe);
    this.group.add(
      this.shadow.group,
      this.device,
      this.patch,
      this.proxy,
      this.spring,
      this.probe,
      this.arrow,
    );
  }

  set showDevice(shown: boolean) {
    this.device.visible = shown;
  }
  set showPatch(shown: boolean) {
    this.patch.visible = shown;
  }

  /** `under`: the surface nearest to the probe. */
  show(run: Run, force_max_N: number, under: Nearest | undefined): void {
    const at = (v: Triple) => new THREE.Vector3(...v);
    const probe = at(run.probe_m);
    const proxy = at(run.proxy_m);
    this.probe.position.copy(probe);
    this.probe.scale.setScalar(0.011 * this.size);
    this.proxy.position.copy(proxy);
    this.proxy.scale.setScalar(0.014 * this.size);
    this.proxy.visible = run.in_contact;
    this.shadow.show(under);
    stretch(this.spring, probe, proxy, 0.003 * this.size);
    this.showForce(at(run.force_N), proxy, force_max_N);
    this.showPatchOf(run.candidates);
    this.showLinkage(run.linkage);
  }

  private showForce(force: THREE.Vector3, from: THREE.Vector3, force_max_N: number): void {
    const length_m = (force.length() / force_max_N) * ARROW * this.size;
    this.arrow.visible = length_m > 0.004 * this.size;
    if (!this.arrow.visible) return;
    const direction = force.clone().normalize();
    const head = Math.min(0.05 * this.size, 0.5 * length_m);
    const neck = from.clone().addScaledVector(direction, length_m - head);
    stretch(this.shaft, from, neck, 0.006 * this.size);
    stretch(this.head, neck, from.clone().addScaledVector(direction, length_m), 0.018 * this.size);
  }

  private showPatchOf(candidates: Triple[]): void {
    const positions = this.patch.geometry.getAttribute('position') as THREE.BufferAttribute;
    const count = Math.min(candidates.length, MAX_CANDIDATES);
    for (let i = 0; i < count; ++i) positions.setXYZ(i, ...candidates[i]);
    positions.needsUpdate = true;
    this.patch.geometry.setDrawRange(0, count);
  }

  private showLinkage(lines: Triple[][]): void {
    let used = 0;
    const next = (geometry: THREE.BufferGeometry): THREE.Mesh => {
      let part = this.device.children[used++] as THREE.Mesh | undefined;
      if (!part) {
        part = new THREE.Mesh(geometry, this.metal);
        this.device.add(part);
      }
      part.geometry = geometry;
      part.rotation.set(0, 0, 0);
      part.visible = true;
      return part;
    };
    const longest = Math.max(0, ...lines.map((line) => length(sub(line[line.length - 1], line[0]))));
    const thick = 0.018 * Math.max(longest, 0.5 * this.size);
    for (const line of lines) {
      line.forEach((point, i) => {
        if (i + 1 < line.length) {
          const width = thick * (1 - (0.5 * i) / line.length);
          const to = line[i + 1];
          stretch(next(this.rod), new THREE.Vector3(...point), new THREE.Vector3(...to), 0.6 * width);
          const joint = next(this.ball);
          joint.position.set(...point);
          joint.scale.setScalar(width);
        }
      });
    }
    for (let i = used; i < this.device.children.length; ++i) this.device.children[i].visible = false;
  }
}

function sub(a: Triple, b: Triple): Triple {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}
