// A model's points by level of detail. Of the server's tree of nodes only those in view are
// fetched; a point budget limits how many are drawn.

import * as THREE from 'three';
import { paletteOf } from './materials';
import { type Hit, type Nearest, type NodeInfo, Search, SearchNode, UNITS } from './search';

export interface Material {
  name?: string;
  rgb?: [number, number, number]; // of its points in the scan
  points: number;
  stiffness_N_m: number;
  static_friction: number;
  dynamic_friction: number;
  texture_height_m: number;
}

/** A frequent colour of the scan. */
export interface ScanColour {
  rgb: [number, number, number];
  points: number;
}

interface Tree {
  name: string;
  points: number;
  spacing_m: number;
  depth: number;
  bounds_min_m: [number, number, number];
  bounds_max_m: [number, number, number];
  materials: Material[];
  colours: ScanColour[];
  is_coloured: boolean; // the colour of each point in the scan is known
  nodes: NodeInfo[];
}

/** What the colours of the points tell. */
export type Overlay = 'none' | 'materials' | 'colours';

/** Camera and height of the picture: the scale of the screen. */
export interface Eye {
  camera: THREE.PerspectiveCamera;
  height_px: number;
}

const MAX_REQUESTS = 4;
// Nodes are refined until the gap between points is below this.
const FINEST_PX = 1.2;
const OVERLAP = 2.0;

const VERTEX = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 normalMatrix;
uniform float diameter;  // of a point, m
uniform float scale;     // pixels of a metre at a distance of 1 m
uniform vec3 colour;
uniform vec3 inner;
uniform int overlay;             // 1: shows the materials, 2: the colours of the scan
uniform sampler2D palette;
in vec4 position;        // x, y, z in 1/65535 of the node's edge; the normal on an octahedron
in float material;
in vec3 rgb;
flat out vec3 vColour;
vec3 unpack(float word) {
  vec2 f = vec2(floor(word / 256.0), mod(word, 256.0)) / 127.5 - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}
vec3 lit(vec3 base, vec3 n) {
  n *= sign(n.z);
  float key = max(dot(n, normalize(vec3(-0.45, 0.6, 0.65))), 0.0);
  float fill = 0.5 + 0.5 * n.y;
  float shine = pow(max(dot(n, normalize(vec3(-0.25, 0.35, 0.9))), 0.0), 24.0);
  return base * (0.28 + 0.22 * fill + 0.6 * key) + 0.10 * shine;
}
void main() {
  vec4 eye = modelViewMatrix * vec4(position.xyz, 1.0);
  vec3 n = normalize(normalMatrix * unpack(position.w));
  vec3 base = colour;
  if (overlay == 1) base = texelFetch(palette, ivec2(int(material + 0.5), 0), 0).rgb;
  if (overlay == 2) base = rgb;
  vColour = lit(n.z >= 0.0 ? base : inner, n);
  gl_Position = projectionMatrix * eye;
  gl_PointSize = clamp(diameter * scale / max(-eye.z, 1e-6), 1.5, 48.0);
}`;

// A point has one normal, and so one colour: without a GPU a picture has far more pixels than points.
const FRAGMENT = `
precision mediump float;
flat in vec3 vColour;
out vec4 result;
void main() {
  vec2 offset = gl_PointCoord - 0.5;
  if (dot(offset, offset) > 0.25) discard;
  result = vec4(vColour, 1.0);
}`;

class CloudNode extends SearchNode {
  object: THREE.Points | undefined;
  requested = false;
  readonly asks = new Set<Overlay>();
  chosen = false;
}

/** The camera in the frame of the model. */
interface ModelView {
  frustum: THREE.Frustum;
  scale: number; // pixels of a metre at a distance of 1 m
  position: THREE.Vector3;
}

/** A node to be drawn or refined; `gap_px`: between its parent's points on the screen. */
interface OpenNode {
  node: CloudNode;
  gap_px: number;
}

function takeCoarsest(open: OpenNode[]): CloudNode {
  let coarsest = 0;
  for (let i = 1; i < open.length; ++i) if (open[i].gap_px > open[coarsest].gap_px) coarsest = i;
  const { node } = open[coarsest];
  open[coarsest] = open[open.length - 1];
  open.pop();
  return node;
}

const spacingOf = (node: CloudNode): number => (node.object?.userData.spacing as number) ?? 0;

export class Cloud {
  readonly group = new THREE.Group();
  drawn = 0;
  private readonly nodes: CloudNode[];
  private readonly search: Search;
  private requests = 0;
  private overlay: Overlay = 'none';
  private readonly material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      diameter: { value: 1 },
      scale: { value: 1 },
      colour: { value: new THREE.Color(0.83, 0.77, 0.69) },
      inner: { value: new THREE.Color(0.42, 0.47, 0.55) },
      overlay: { value: 0 },
      palette: { value: new THREE.Texture() as THREE.Texture },
    },
  });

  private constructor(
    private readonly number: number,
    readonly tree: Tree,
    private readonly changed: () => void,
  ) {
    this.nodes = tree.nodes.map((info) => new CloudNode(info));
    this.search = new Search(this.nodes);
    this.group.matrixAutoUpdate = false;
    this.material.uniforms.palette.value = paletteOf(tree.materials.length);
  }

  /** Calls `changed` whenever more points have arrived. */
  static async load(number: number, changed: () => void): Promise<Cloud> {
    const answer = await fetch(`/model/${number}`);
    if (!answer.ok) throw new Error(`model ${number}: ${answer.status}`);
    return new Cloud(number, (await answer.json()) as Tree, changed);
  }

  get box(): THREE.Box3 {
    const { bounds_min_m, bounds_max_m } = this.tree;
    return new THREE.Box3(new THREE.Vector3(...bounds_min_m), new THREE.Vector3(...bounds_max_m));
  }

  // Searches in the frame of the scene, in the points that have arrived.

  /** The visible surface on the ray. */
  hit(ray: THREE.Ray): Hit | undefined {
    const found = this.search.hit(ray.clone().applyMatrix4(this.inverse));
    return found && this.toScene(found);
  }
  isClear(from: THREE.Vector3, to: THREE.Vector3, margin: number): boolean {
    const { inverse } = this;
    return this.search.isClear(from.clone().applyMatrix4(inverse), to.clone().applyMatrix4(inverse), margin);
  }
  nearest(place: THREE.Vector3): Nearest | undefined {
    const found = this.search.nearest(place.clone().applyMatrix4(this.inverse));
    return found && this.toScene(found);
  }
  /** Largest distance of a point from `centre`. */
  farthest(centre: THREE.Vector3): number {
    return this.search.farthest(centre.clone().applyMatrix4(this.inverse));
  }
  private get inverse(): THREE.Matrix4 {
    return this.group.matrix.clone().invert();
  }
  private toScene<P extends { point: THREE.Vector3; normal: THREE.Vector3 }>(place: P): P {
    place.point.applyMatrix4(this.group.matrix);
    place.normal.transformDirection(this.group.matrix);
    return place;
  }

  /** With fewer than two materials there is nothing to show. */
  private has(overlay: Overlay): boolean {
    return overlay === 'materials' ? this.tree.materials.length > 1 : this.tree.is_coloured;
  }
  showOverlay(overlay: Overlay): void {
    this.overlay = this.has(overlay) ? overlay : 'none';
    for (const node of this.nodes) if (node.object) this.requestOverlay(node);
  }
  private requestOverlay(node: CloudNode): void {
    const { overlay } = this;
    const geometry = node.object?.geometry;
    if (overlay === 'none' || !geometry || node.asks.has(overlay)) return;
    node.asks.add(overlay);
    fetch(`/model/${this.number}/${overlay}/${this.nodes.indexOf(node)}`)
      .then((answer) => (answer.ok ? answer.arrayBuffer() : Promise.reject(new Error('refused'))))
      .then((bytes) => {
        const values = new Uint8Array(bytes);
        if (overlay === 'materials') geometry.setAttribute('material', new THREE.BufferAttribute(values, 1));
        else geometry.setAttribute('rgb', new THREE.BufferAttribute(values, 3, true));
      })
      .catch(() => setTimeout(() => node.asks.delete(overlay), 1000))
      .finally(() => this.changed());
  }
  /** Of a node: its points have the usual colour until their values have arrived. */
  private overlayOf(geometry: THREE.BufferGeometry): number {
    if (this.overlay === 'materials' && geometry.hasAttribute('material')) return 1;
    return this.overlay === 'colours' && geometry.hasAttribute('rgb') ? 2 : 0;
  }

  dispose(): void {
    for (const node of this.nodes) node.object?.geometry.dispose();
    (this.material.uniforms.palette.value as THREE.Texture).dispose();
    this.material.dispose();
  }

  /** Chooses the nodes to draw, at most `budget` points, those with the widest gaps refined first. */
  choose(eye: Eye, budget: number): void {
    const view = this.viewOf(eye);
    this.material.uniforms.scale.value = view.scale;
    for (const node of this.nodes) node.chosen = false;
    const missing: CloudNode[] = [];
    const open: OpenNode[] = [{ node: this.nodes[0], gap_px: Infinity }];
    this.drawn = 0;
    while (open.length > 0) {
      const node = takeCoarsest(open);
      if (this.drawn + node.info.points > budget && this.drawn > 0) break;
      if (!node.object) {
        missing.push(node);
        continue;
      }
      node.chosen = true;
      this.drawn += node.info.points;
      this.openChildren(node, view, open);
    }
    this.show();
    for (const node of missing) this.request(node);
  }

  private viewOf(eye: Eye): ModelView {
    const { camera } = eye;
    const toScreen = new THREE.Matrix4()
      .multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse)
      .multiply(this.group.matrix);
    return {
      frustum: new THREE.Frustum().setFromProjectionMatrix(toScreen),
      scale: eye.height_px / (2 * Math.tan(THREE.MathUtils.degToRad(camera.fov / 2))),
      position: camera.position.clone().applyMatrix4(this.group.matrix.clone().invert()),
    };
  }

  /** Adds the children of `node` that are in view and worth refining to `open`. */
  private openChildren(node: CloudNode, view: ModelView, open: OpenNode[]): void {
    for (const number of node.info.children) {
      const child = this.nodes[number];
      if (!view.frustum.intersectsSphere(new THREE.Sphere(child.centre, child.radius))) continue;
      const distance = Math.max(view.position.distanceTo(child.centre) - child.radius, 1e-3);
      const gap_px = (node.info.spacing_m * view.scale) / distance;
      if (gap_px > FINEST_PX) open.push({ node: child, gap_px });
    }
  }

  /** Shows the chosen nodes; points of the finest level drawn are as wide as the gaps between them. */
  private show(): void {
    // Children have higher numbers than their parents.
    for (let i = this.nodes.length - 1; i >= 0; --i) {
      const { info, object, chosen } = this.nodes[i];
      if (!object) continue;
      object.visible = chosen;
      if (!chosen) continue;
      const children = info.children.map((child) => this.nodes[child]);
      const isCovered = children.length > 0 && children.every((child) => child.chosen);
      object.userData.spacing = isCovered ? Math.max(...children.map(spacingOf)) : info.spacing_m;
    }
  }

  private request(node: CloudNode): void {
    if (node.requested || this.requests >= MAX_REQUESTS) return;
    node.requested = true;
    ++this.requests;
    fetch(`/model/${this.number}/points/${this.nodes.indexOf(node)}`)
      .then((answer) => (answer.ok ? answer.arrayBuffer() : Promise.reject(new Error('refused'))))
      .then((bytes) => this.add(node, bytes))
      .catch(() => setTimeout(() => (node.requested = false), 1000))
      .finally(() => {
        --this.requests;
        this.changed();
      });
  }

  private add(node: CloudNode, bytes: ArrayBuffer): void {
    const geometry = new THREE.BufferGeometry();
    node.words = new Uint16Array(bytes);
    geometry.setAttribute('position', new THREE.BufferAttribute(node.words, 4));
    const object = new THREE.Points(geometry, this.material);
    object.frustumCulled = false; // done by choose()
    object.position.set(...node.info.min_m);
    object.scale.setScalar(node.info.edge_m / UNITS);
    object.userData.spacing = node.info.spacing_m;
    object.onBeforeRender = () => {
      this.material.uniforms.diameter.value = OVERLAP * (object.userData.spacing as number);
      this.material.uniforms.overlay.value = this.overlayOf(geometry);
      this.material.uniformsNeedUpdate = true;
    };
    node.object = object;
    this.group.add(object);
    this.requestOverlay(node);
  }
}

/** The cubes of the blob's octree on one level, as lines. */
export async function loadOctants(number: number, level: number): Promise<THREE.LineSegments> {
  const answer = await fetch(`/model/${number}/octants/${level}`);
  if (!answer.ok) throw new Error(`octants: ${answer.status}`);
  const bytes = await answer.arrayBuffer();
  const edge = new DataView(bytes).getFloat32(4, true);
  const corners = new Float32Array(bytes, 8);
  const cube: number[] = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (let side = 0; side < 4; ++side) {
      const from = [0, 0, 0];
      from[(axis + 1) % 3] = side & 1;
      from[(axis + 2) % 3] = side >> 1;
      const to = [...from];
      to[axis] = 1;
      cube.push(...from, ...to);
    }
  }
  const lines = new Float32Array((corners.length / 3) * cube.length);
  for (let i = 0, at = 0; i < corners.length; i += 3) {
    for (let k = 0; k < cube.length; ++k) lines[at++] = corners[i + (k % 3)] + edge * cube[k];
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(lines, 3));
  const material = new THREE.LineBasicMaterial({ color: 0x4f8fc3, transparent: true, opacity: 0.35 });
  return new THREE.LineSegments(geometry, material);
}
