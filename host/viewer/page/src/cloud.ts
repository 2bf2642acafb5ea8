// A model's points by level of detail: the server's tree of nodes, of which only what the view
// needs is fetched, and only as much is drawn as the machine keeps up with.

import * as THREE from 'three';

interface NodeInfo {
  min_m: [number, number, number];
  edge_m: number;
  spacing_m: number;
  points: number;
  children: number[];
}

interface Tree {
  name: string;
  points: number;
  spacing_m: number;
  depth: number;
  bounds_min_m: [number, number, number];
  bounds_max_m: [number, number, number];
  nodes: NodeInfo[];
}

/** How the camera sees a metre. */
export interface Eye {
  camera: THREE.PerspectiveCamera;
  height_px: number;
}

const MOST_REQUESTS = 4;
// Points nearer to each other than this are one on the screen.
const FINEST_PX = 1.2;
const OVERLAP = 2.0;
const UNITS = 65535;

const VERTEX = `
precision highp float;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 normalMatrix;
uniform float diameter;  // of a point, m
uniform float scale;     // pixels of a metre at a distance of 1 m
in vec4 position;        // x, y, z in 1/65535 of the node's edge; the normal on an octahedron
out vec3 vNormal;
vec3 unpack(float word) {
  vec2 f = vec2(floor(word / 256.0), mod(word, 256.0)) / 127.5 - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return normalize(n);
}
void main() {
  vec4 eye = modelViewMatrix * vec4(position.xyz, 1.0);
  vNormal = normalize(normalMatrix * unpack(position.w));
  gl_Position = projectionMatrix * eye;
  gl_PointSize = clamp(diameter * scale / max(-eye.z, 1e-6), 1.5, 48.0);
}`;

const FRAGMENT = `
precision mediump float;
uniform vec3 colour, inner;
in vec3 vNormal;
out vec4 result;
void main() {
  vec2 away = gl_PointCoord - 0.5;
  if (dot(away, away) > 0.25) discard;
  vec3 n = normalize(vNormal);
  vec3 base = n.z >= 0.0 ? colour : inner;
  n *= sign(n.z);
  float key = max(dot(n, normalize(vec3(-0.45, 0.6, 0.65))), 0.0);
  float fill = 0.5 + 0.5 * n.y;
  float shine = pow(max(dot(n, normalize(vec3(-0.25, 0.35, 0.9))), 0.0), 24.0);
  result = vec4(base * (0.28 + 0.22 * fill + 0.6 * key) + 0.10 * shine, 1.0);
}`;

class CloudNode {
  object: THREE.Points | undefined;
  requested = false;
  chosen = false;
  readonly centre: THREE.Vector3;
  readonly radius: number;

  constructor(readonly info: NodeInfo) {
    const half = info.edge_m / 2;
    this.centre = new THREE.Vector3(...info.min_m).addScalar(half);
    this.radius = half * Math.sqrt(3);
  }
}

export class Cloud {
  readonly group = new THREE.Group();
  drawn = 0;
  private nodes: CloudNode[] = [];
  private requests = 0;
  private readonly material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: {
      diameter: { value: 1 },
      scale: { value: 1 },
      colour: { value: new THREE.Color(0.83, 0.77, 0.69) },
      inner: { value: new THREE.Color(0.42, 0.47, 0.55) },
    },
  });

  private constructor(
    private readonly number: number,
    readonly tree: Tree,
    private readonly changed: () => void,
  ) {
    this.nodes = tree.nodes.map((info) => new CloudNode(info));
    this.group.matrixAutoUpdate = false;
  }

  /** `changed` is called whenever there is more to draw. */
  static async load(number: number, changed: () => void): Promise<Cloud> {
    const answer = await fetch(`/model/${number}`);
    if (!answer.ok) throw new Error(`model ${number}: ${answer.status}`);
    return new Cloud(number, (await answer.json()) as Tree, changed);
  }

  get box(): THREE.Box3 {
    const { bounds_min_m, bounds_max_m } = this.tree;
    return new THREE.Box3(new THREE.Vector3(...bounds_min_m), new THREE.Vector3(...bounds_max_m));
  }

  dispose(): void {
    for (const node of this.nodes) node.object?.geometry.dispose();
    this.material.dispose();
  }

  /** Chooses what to draw, at most `budget` points, the coarsest on the screen refined first. */
  choose(eye: Eye, budget: number): void {
    const frustum = new THREE.Frustum().setFromProjectionMatrix(
      new THREE.Matrix4()
        .multiplyMatrices(eye.camera.projectionMatrix, eye.camera.matrixWorldInverse)
        .multiply(this.group.matrix),
    );
    const scale = eye.height_px / (2 * Math.tan(THREE.MathUtils.degToRad(eye.camera.fov / 2)));
    this.material.uniforms.scale!.value = scale;
    const from = eye.camera.position.clone().applyMatrix4(this.group.matrix.clone().invert());
    for (const node of this.nodes) node.chosen = false;
    const wanted: CloudNode[] = [];
    let open = [{ node: this.nodes[0]!, size: Infinity }];
    this.drawn = 0;
    while (open.length > 0) {
      let best = 0;
      for (let i = 1; i < open.length; ++i) if (open[i]!.size > open[best]!.size) best = i;
      const { node } = open[best]!;
      open[best] = open[open.length - 1]!;
      open.pop();
      if (this.drawn + node.info.points > budget && this.drawn > 0) break;
      if (!node.object) {
        wanted.push(node);
        continue;
      }
      node.chosen = true;
      this.drawn += node.info.points;
      for (const child of node.info.children) {
        const below = this.nodes[child]!;
        const sphere = new THREE.Sphere(below.centre, below.radius);
        if (!frustum.intersectsSphere(sphere)) continue;
        const distance = Math.max(from.distanceTo(below.centre) - below.radius, 1e-3);
        const spacing_px = (node.info.spacing_m * scale) / distance;
        if (spacing_px > FINEST_PX) open.push({ node: below, size: spacing_px });
      }
    }
    this.show();
    for (const node of wanted) this.request(node);
  }

  /** A point is as wide as the gaps where it is the finest that is drawn. */
  private show(): void {
    // Children have higher numbers than their parents.
    for (let i = this.nodes.length - 1; i >= 0; --i) {
      const node = this.nodes[i]!;
      if (!node.object) continue;
      node.object.visible = node.chosen;
      if (!node.chosen) continue;
      let spacing = node.info.spacing_m;
      const below = node.info.children.map((child) => this.nodes[child]!);
      if (below.length > 0 && below.every((child) => child.chosen)) {
        spacing = Math.max(...below.map((child) => child.object!.userData.spacing as number));
      }
      node.object.userData.spacing = spacing;
    }
  }

  private request(node: CloudNode): void {
    if (node.requested || this.requests >= MOST_REQUESTS) return;
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
    geometry.setAttribute('position', new THREE.BufferAttribute(new Uint16Array(bytes), 4));
    const object = new THREE.Points(geometry, this.material);
    object.frustumCulled = false; // choose() has done it
    object.position.set(...node.info.min_m);
    object.scale.setScalar(node.info.edge_m / UNITS);
    object.userData.spacing = node.info.spacing_m;
    object.onBeforeRender = () => {
      this.material.uniforms.diameter!.value = OVERLAP * (object.userData.spacing as number);
      this.material.uniformsNeedUpdate = true;
    };
    node.object = object;
    this.group.add(object);
  }
}

/** Cubes of the blob's octree on a level, as lines. */
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
    for (let k = 0; k < cube.length; ++k) lines[at++] = corners[i + (k % 3)]! + edge * cube[k]!;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(lines, 3));
  const material = new THREE.LineBasicMaterial({ color: 0x4f8fc3, transparent: true, opacity: 0.35 });
  return new THREE.LineSegments(geometry, material);
}
