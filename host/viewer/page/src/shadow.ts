// The place of the surface under the probe: a dark spot, and a ring that widens with the distance.

import * as THREE from 'three';
import type { Nearest } from './search';

const Z = new THREE.Vector3(0, 0, 1);
// Relative to the size of the model.
const SPOT = 0.012;
const WIDEST = 0.08;
const ABOVE = 0.004; // so that the points around do not cover it

export class Shadow {
  readonly group = new THREE.Group();
  private readonly ring: THREE.Mesh;

  constructor(
    private readonly size: number,
    colour: number,
  ) {
    const flat = (geometry: THREE.BufferGeometry, color: number, opacity: number) =>
      new THREE.Mesh(
        geometry,
        new THREE.MeshBasicMaterial({
          color,
          opacity,
          transparent: true,
          side: THREE.DoubleSide,
          depthWrite: false,
        }),
      );
    const spot = flat(new THREE.CircleGeometry(SPOT * size, 24), 0x000000, 0.45);
    this.ring = flat(new THREE.RingGeometry(0.86, 1, 40), colour, 0.9);
    this.group.add(spot, this.ring);
    this.group.visible = false;
  }

  show(under: Nearest | undefined): void {
    this.group.visible = under !== undefined;
    if (!under) return;
    this.group.position.copy(under.point).addScaledVector(under.normal, ABOVE * this.size);
    this.group.quaternion.setFromUnitVectors(Z, under.normal);
    const distance = Math.max(under.height, 0);
    this.ring.scale.setScalar(Math.min(1.6 * SPOT * this.size + 0.4 * distance, WIDEST * this.size));
  }
}
