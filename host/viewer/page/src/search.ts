// Searches in the loaded points of a model: the surface on a ray, and the surface nearest to a place.
// Points are grouped in the nodes of a tree; see cloud.ts.

import * as THREE from 'three';

export interface NodeInfo {
  min_m: [number, number, number];
  edge_m: number;
  spacing_m: number;
  points: number;
  children: number[];
}

/** A place on the surface; the normal points outward. */
export interface Place {
  point: THREE.Vector3;
  normal: THREE.Vector3;
}

export interface Hit extends Place {
  distance: number; // from the origin of the ray, m
}

export interface Nearest extends Place {
  height: number; // of the place above the surface, m; negative: inside
}

/** Words of a point: x, y, z in 1/UNITS of the node's edge, and the normal on an octahedron. */
const WORDS = 4;
export const UNITS = 65535;
// A plane through a point that the ray meets at a flatter angle gives no distance.
const FLATTEST = 0.2;

export class SearchNode {
  readonly centre: THREE.Vector3;
  readonly radius: number;
  /** Four words for each point; undefined until they have arrived. */
  words: Uint16Array | undefined;

  constructor(readonly info: NodeInfo) {
    const half = info.edge_m / 2;
    this.centre = new THREE.Vector3(...info.min_m).addScalar(half);
    this.radius = half * Math.sqrt(3);
  }
}

function normalOf(word: number, into: THREE.Vector3): THREE.Vector3 {
  const u = Math.floor(word / 256) / 127.5 - 1;
  const v = (word % 256) / 127.5 - 1;
  const z = 1 - Math.abs(u) - Math.abs(v);
  if (z >= 0) return into.set(u, v, z).normalize();
  const x = (1 - Math.abs(v)) * (u < 0 ? -1 : 1);
  const y = (1 - Math.abs(u)) * (v < 0 ? -1 : 1);
  return into.set(x, y, z).normalize();
}

/** A point near a ray. */
interface Candidate {
  along: number; // of the ray, m
  weight: number; // 1 on the ray, 0 at the edge of the drawn point
  gap: number; // between points, m
  point: THREE.Vector3;
  normal: THREE.Vector3;
}

export class Search {
  constructor(private readonly nodes: SearchNode[]) {}

  /** The visible surface on the ray. Undefined: none, or its inner side. */
  hit(ray: THREE.Ray): Hit | undefined {
    const candidates = this.candidates(ray, 0);
    const first = candidates.reduce((least, one) => Math.min(least, one.along), Infinity);
    const near = candidates.filter((one) => one.along < first + 2 * one.gap);
    const facing = near.filter((one) => one.normal.dot(ray.direction) < 0);
    if (facing.length === 0) return undefined;
    const normal = new THREE.Vector3();
    let total = 0;
    let distance = 0;
    for (const one of facing) {
      normal.addScaledVector(one.normal, one.weight);
      distance += one.weight * distanceToPlane(ray, one);
      total += one.weight;
    }
    distance /= total;
    return { point: ray.at(distance, new THREE.Vector3()), normal: normal.normalize(), distance };
  }

  /** True if no point is within `margin` of the line. */
  isClear(from: THREE.Vector3, to: THREE.Vector3, margin: number): boolean {
    const length = from.distanceTo(to);
    if (length === 0) return true;
    const ray = new THREE.Ray(from, to.clone().sub(from).divideScalar(length));
    return this.candidates(ray, margin).every((one) => one.along > length + margin);
  }

  nearest(place: THREE.Vector3): Nearest | undefined {
    const found = { squared: Infinity, node: this.nodes[0], index: -1 };
    this.searchNear(place, this.nodes[0], found);
    const { words } = found.node;
    if (found.index < 0 || !words) return undefined;
    const point = pointOf(found.node, words, found.index, new THREE.Vector3());
    const normal = normalOf(words[found.index + 3], new THREE.Vector3());
    const above = normal.dot(place.clone().sub(point));
    const distance = Math.sqrt(found.squared);
    // Near the surface its plane is more exact than its points.
    if (distance > 3 * found.node.info.spacing_m)
      return { point, normal, height: Math.sign(above) * distance };
    return { point: place.clone().addScaledVector(normal, -above), normal, height: above };
  }

  /** Largest distance of a point from `centre`, estimated by the coarsest points. */
  farthest(centre: THREE.Vector3): number {
    const [root] = this.nodes;
    const point = new THREE.Vector3();
    let squared = 0;
    for (let i = 0; root.words && i < root.words.length; i += WORDS) {
      squared = Math.max(squared, pointOf(root, root.words, i, point).distanceToSquared(centre));
    }
    return Math.sqrt(squared) + root.info.spacing_m;
  }

  private searchNear(
    place: THREE.Vector3,
    node: SearchNode,
    found: { squared: number; node: SearchNode; index: number },
  ): void {
    if (!node.words) return;
    const point = new THREE.Vector3();
    for (let i = 0; i < node.words.length; i += WORDS) {
      const squared = pointOf(node, node.words, i, point).distanceToSquared(place);
      if (squared < found.squared) Object.assign(found, { squared, node, index: i });
    }
    const gap = (child: SearchNode) => Math.max(0, child.centre.distanceTo(place) - child.radius);
    const children = node.info.children.map((child) => this.nodes[child]).sort((a, b) => gap(a) - gap(b));
    for (const child of children) {
      if (gap(child) ** 2 < found.squared) this.searchNear(place, child, found);
    }
  }

  /** Points that are drawn over the ray, or within `margin` of it. */
  private candidates(ray: THREE.Ray, margin: number): Candidate[] {
    const gaps = this.gaps();
    const list: Candidate[] = [];
    this.nodes.forEach((node, i) => {
      const reach = gaps[i] + margin;
      if (node.words && ray.distanceToPoint(node.centre) < node.radius + reach) {
        addCandidates(ray, node, node.words, gaps[i], reach, list);
      }
    });
    return list;
  }

  /** Gap between the points around each node's, of the finest level that has arrived there. */
  private gaps(): Float64Array {
    const gaps = new Float64Array(this.nodes.length);
    // Children have higher numbers than their parents.
    for (let i = this.nodes.length - 1; i >= 0; --i) {
      const { children, spacing_m } = this.nodes[i].info;
      const isCovered = children.length > 0 && children.every((child) => this.nodes[child].words);
      gaps[i] = isCovered ? Math.max(...children.map((child) => gaps[child])) : spacing_m;
    }
    return gaps;
  }
}

function pointOf(node: SearchNode, words: Uint16Array, i: number, into: THREE.Vector3): THREE.Vector3 {
  const { min_m, edge_m } = node.info;
  const unit = edge_m / UNITS;
  return into.set(min_m[0] + words[i] * unit, min_m[1] + words[i + 1] * unit, min_m[2] + words[i + 2] * unit);
}

function addCandidates(
  ray: THREE.Ray,
  node: SearchNode,
  words: Uint16Array,
  gap: number,
  reach: number,
  list: Candidate[],
): void {
  const point = new THREE.Vector3();
  const offset = new THREE.Vector3();
  for (let i = 0; i < words.length; i += WORDS) {
    offset.copy(pointOf(node, words, i, point)).sub(ray.origin);
    const along = offset.dot(ray.direction);
    const aside = 1 - (offset.lengthSq() - along * along) / (reach * reach);
    if (along < 0 || aside <= 0) continue;
    const normal = normalOf(words[i + 3], new THREE.Vector3());
    list.push({ along, weight: aside * aside, gap, point: point.clone(), normal });
  }
}

/** Where the ray meets the plane through a point; at a flat angle, as far as the point. */
function distanceToPlane(ray: THREE.Ray, one: Candidate): number {
  const slope = one.normal.dot(ray.direction);
  if (slope > -FLATTEST) return one.along;
  const distance = one.normal.dot(one.point.clone().sub(ray.origin)) / slope;
  return Math.abs(distance - one.along) < 2 * one.gap ? distance : one.along;
}
