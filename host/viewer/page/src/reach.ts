// The border of the device's workspace, as the server draws it.

import * as THREE from 'three';
import type { Triple } from './messages';

interface Shape {
  rows?: number;
  columns?: number;
  points_m?: Triple[];
}

const FACE = { color: 0x4f8fc3, transparent: true, opacity: 0.1, depthWrite: false, side: THREE.DoubleSide };
const LINE = { color: 0x4f8fc3, transparent: true, opacity: 0.35 };

/** The two triangles of each cell of a grid whose rows are closed. */
function facesOf(rows: number, columns: number): number[] {
  const faces: number[] = [];
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const next = (column + 1) % columns;
      const [a, b] = [row * columns + column, row * columns + next];
      faces.push(a, b, a + columns, b, b + columns, a + columns);
    }
  }
  return faces;
}

/** The lines along the rows, and every third one across them. */
function linesOf(rows: number, columns: number): number[] {
  const lines: number[] = [];
  for (let row = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column) {
      const at = row * columns + column;
      lines.push(at, row * columns + ((column + 1) % columns));
      if (row + 1 < rows && column % 3 === 0) lines.push(at, at + columns);
    }
  }
  return lines;
}

export class Reach {
  readonly group = new THREE.Group();

  constructor() {
    this.group.visible = false;
    this.group.renderOrder = 1;
  }

  /** Fetches the shape of the present device. */
  async load(): Promise<void> {
    const answer = await fetch('/reach.json');
    if (!answer.ok) throw new Error(`the reach of the device: ${answer.status}`);
    const { rows = 0, columns = 0, points_m = [] } = (await answer.json()) as Shape;
    this.clear();
    if (points_m.length === 0) return;
    const points = new THREE.BufferAttribute(new Float32Array(points_m.flat()), 3);
    const part = (index: number[]) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute('position', points);
      geometry.setIndex(index);
      return geometry;
    };
    this.group.add(
      new THREE.Mesh(part(facesOf(rows, columns)), new THREE.MeshBasicMaterial(FACE)),
      new THREE.LineSegments(part(linesOf(rows, columns)), new THREE.LineBasicMaterial(LINE)),
    );
  }

  private clear(): void {
    for (const child of [...this.group.children]) {
      child.removeFromParent();
      (child as THREE.Mesh).geometry.dispose();
    }
  }
}
