// The picture: models, devices and markers. Drawn on changes only, with as many points and pixels as
// the frame rate allows; drawn once more with more points and all pixels when nothing moves.

import * as THREE from 'three';
import { Orbit } from './camera';
import { Cloud, loadOctants, type Material, type Overlay, type ScanColour } from './cloud';
import { COLOURS, Markers } from './markers';
import type { Frame, Run } from './messages';
import type { Obstacles } from './route';
import type { Hit, Nearest } from './search';

const MIN_POINTS = 30_000;
const MAX_POINTS = 3_000_000;
// Share of the pixels along each side, when even MIN_POINTS take too long; all of them from SHARP_POINTS on.
const COARSE = 0.5;
const SHARP_POINTS = 8 * MIN_POINTS;
const STILL_MS = 350;
// Frame times above SLOW_MS reduce the number of points, those below FAST_MS raise it.
const SLOW_MS = 40;
const FAST_MS = 20;
const FORCE_N = 8;
// The hand keeps this distance from the models on its path around them, relative to their size.
const MARGIN = 0.015;

export class View implements Obstacles {
  readonly orbit = new Orbit();
  /** Number of points in the last picture. */
  drawn = 0;
  onPicture: (() => void) | undefined;
  private readonly renderer: THREE.WebGLRenderer;
  private readonly scene = new THREE.Scene();
  private readonly hand: THREE.Mesh;
  private clouds: Cloud[] = [];
  private markers: Markers[] = [];
  private octants: THREE.Object3D[] = [];
  /** Of the models: the diameter of a ball around them, m. */
  size = 0.1;
  private budget = 250_000;
  private isCoarse = false;
  private dirty = true;
  private moved_ms = 0;
  private refined = false;
  private refined_ms = 0;
  private last_ms = 0;
  private seen = '';
  /** Of each controller: the surface nearest to its probe. */
  under: (Nearest | undefined)[] = [];
  private shown = { device: true, patch: true };
  private held: THREE.Matrix4 | undefined;
  private isPlaced = true; // the models are where the last frame says

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !isSoftware(), alpha: true });
    this.renderer.setScissorTest(true);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x667080, 2.2));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, -0.6, 1.5);
    this.scene.add(sun);
    this.hand = new THREE.Mesh(
      new THREE.TorusGeometry(1, 0.12, 8, 32),
      new THREE.MeshBasicMaterial({ color: COLOURS.hand, depthTest: false, transparent: true }),
    );
    this.hand.renderOrder = 3;
    this.scene.add(this.hand);
    new ResizeObserver(() => this.resize()).observe(canvas);
    requestAnimationFrame((now) => this.turn(now));
  }

  /** Loads the models of the server. */
  async load(count: number): Promise<void> {
    for (const cloud of this.clouds) {
      this.scene.remove(cloud.group);
      cloud.dispose();
    }
    this.clouds = await Promise.all(
      Array.from({ length: count }, (_, i) => Cloud.load(i, () => this.arrived())),
    );
    for (const cloud of this.clouds) this.scene.add(cloud.group);
    this.size = 2 * this.around().radius;
    for (const markers of this.markers) this.scene.remove(markers.group);
    this.markers = [];
    this.hand.scale.setScalar(0.022 * this.size);
    this.resize();
    this.showAll();
    this.isPlaced = false;
  }

  /** The ball around all models, where they are. */
  private around(): THREE.Sphere {
    const box = new THREE.Box3();
    for (const cloud of this.clouds) box.union(cloud.box.applyMatrix4(cloud.group.matrix));
    return box.getBoundingSphere(new THREE.Sphere());
  }
  /** Looks at the front of all models, as a new page does. */
  showAll(): void {
    this.orbit.fit(this.around());
    this.changed();
  }

  /** Adds an object that stays when the models change. */
  add(object: THREE.Object3D): void {
    this.scene.add(object);
  }
  /** The centre of the first model, in its own frame. */
  get centre(): THREE.Vector3 {
    return this.clouds[0]?.box.getCenter(new THREE.Vector3()) ?? new THREE.Vector3();
  }
  /** Shows the first model with this matrix instead of the pose of the frames; undefined: as they say. */
  hold(matrix: THREE.Matrix4 | undefined): void {
    this.held = matrix;
    if (matrix) this.clouds[0]?.group.matrix.copy(matrix);
    this.changed();
  }

  get deepest(): number {
    return Math.max(0, ...this.clouds.map((cloud) => cloud.tree.depth));
  }

  /** Ray through a pixel of the canvas. */
  rayAt(x: number, y: number): THREE.Ray {
    const { clientWidth, clientHeight } = this.canvas;
    const width = clientWidth / this.sides;
    const { camera } = this.orbit;
    const place = new THREE.Vector3((2 * (x % width)) / width - 1, 1 - (2 * y) / clientHeight, 0.5);
    place.unproject(camera);
    return new THREE.Ray(camera.position.clone(), place.sub(camera.position).normalize());
  }
  /** Pixel of the canvas that shows a place; of two pictures side by side, in the left one. */
  pixelOf(place: THREE.Vector3): THREE.Vector2 {
    const { clientWidth, clientHeight } = this.canvas;
    const seen = place.clone().project(this.orbit.camera);
    return new THREE.Vector2(
      (0.5 * (seen.x + 1) * clientWidth) / this.sides,
      0.5 * (1 - seen.y) * clientHeight,
    );
  }
  /** Number of pictures side by side. */
  get sides(): number {
    return Math.max(1, this.markers.length);
  }

  /** The visible surface on a ray. */
  hit(ray: THREE.Ray): Hit | undefined {
    const hits = this.clouds.map((cloud) => cloud.hit(ray)).filter((hit) => hit !== undefined);
    return hits.sort((a, b) => a.distance - b.distance)[0];
  }
  /** The surface nearest to a place. */
  nearest(place: THREE.Vector3): Nearest | undefined {
    const all = this.clouds.map((cloud) => cloud.nearest(place)).filter((one) => one !== undefined);
    return all.sort((a, b) => Math.abs(a.height) - Math.abs(b.height))[0];
  }
  isClear(from: THREE.Vector3, to: THREE.Vector3): boolean {
    return this.clouds.every((cloud) => cloud.isClear(from, to, MARGIN * this.size));
  }
  ball(): THREE.Sphere {
    const box = new THREE.Box3();
    for (const cloud of this.clouds) box.union(cloud.box.applyMatrix4(cloud.group.matrix));
    const center = box.getCenter(new THREE.Vector3());
    return new THREE.Sphere(center, Math.max(...this.clouds.map((cloud) => cloud.farthest(center))));
  }

  show(frame: Frame): void {
    frame.bodies.forEach((rows, i) => {
      const m = rows as number[];
      this.clouds[i]?.group.matrix.set(
        m[0],
        m[1],
        m[2],
        m[3],
        m[4],
        m[5],
        m[6],
        m[7],
        m[8],
        m[9],
        m[10],
        m[11],
        0,
        0,
        0,
        1,
      );
    });
    if (this.held) this.clouds[0]?.group.matrix.copy(this.held);
    if (!this.isPlaced && this.clouds.length > 0) {
      this.isPlaced = true;
      this.showAll();
    }
    while (this.markers.length < frame.runs.length && this.clouds.length > 0) {
      const markers = new Markers(this.size);
      this.markers.push(markers);
      this.scene.add(markers.group);
    }
    this.dropMarkers(frame.runs.length);
    this.under = frame.runs.map((run) => this.nearest(new THREE.Vector3(...run.probe_m)));
    frame.runs.forEach((run, i) => {
      this.markers[i]?.show(run, frame.settings?.force_max_N ?? FORCE_N, this.under[i]);
    });
    this.hand.visible = frame.hand_m !== undefined;
    if (frame.hand_m) this.hand.position.set(...frame.hand_m);
    this.applyShown();
    // Changes below a micrometre are invisible: no new picture.
    const seen = JSON.stringify([frame.runs.map(look), frame.hand_m?.map(micrometres), frame.bodies]);
    if (seen !== this.seen) this.changed();
    this.seen = seen;
  }

  private dropMarkers(count: number): void {
    for (const markers of this.markers.splice(count)) this.scene.remove(markers.group);
  }

  setShown(shown: { device: boolean; patch: boolean }): void {
    this.shown = shown;
    this.applyShown();
    this.changed();
  }
  private applyShown(): void {
    for (const markers of this.markers) {
      markers.showDevice = this.shown.device;
      markers.showPatch = this.shown.patch;
    }
  }

  async showOctants(level: number | undefined): Promise<void> {
    const lines =
      level === undefined ? [] : await Promise.all(this.clouds.map((_, i) => loadOctants(i, level)));
    for (const old of this.octants) old.removeFromParent();
    lines.forEach((line, i) => {
      this.clouds[i]?.group.add(line);
    });
    this.octants = lines;
    this.changed();
  }

  /** Of the first model. */
  get materials(): Material[] {
    return this.clouds[0]?.tree.materials ?? [];
  }
  /** Of the scan of the first model, if they are known. */
  get colours(): ScanColour[] {
    return this.clouds[0]?.tree.colours ?? [];
  }
  /** The colours of the points of the first model are known. */
  get isColoured(): boolean {
    return this.clouds[0]?.tree.is_coloured ?? false;
  }
  showOverlay(overlay: Overlay): void {
    for (const cloud of this.clouds) cloud.showOverlay(overlay);
    this.changed();
  }

  changed(): void {
    this.dirty = true;
    this.moved_ms = performance.now();
  }

  /** More points are here. While nothing moves, the next picture is a fine one. */
  private arrived(): void {
    if (performance.now() - this.moved_ms > STILL_MS) this.refined = false;
    else this.dirty = true;
  }

  /** The picture as a PNG file. */
  picture(): Promise<Blob | null> {
    this.draw(MAX_POINTS, 1);
    return new Promise((done) => this.canvas.toBlob(done, 'image/png'));
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.changed();
  }

  private turn(now: number): void {
    requestAnimationFrame((next) => this.turn(next));
    const took = now - this.last_ms;
    this.last_ms = now;
    if (this.dirty) {
      this.dirty = false;
      this.refined = false;
      this.draw(this.budget, this.isCoarse ? COARSE : 1);
      this.adapt(took);
    } else if (!this.refined && now - Math.max(this.moved_ms, this.refined_ms) > STILL_MS) {
      this.refined = true;
      this.refined_ms = now;
      this.draw(Math.max(2 * this.budget, 500_000), 1);
    }
  }

  private adapt(took_ms: number): void {
    if (took_ms > SLOW_MS && took_ms < 1000) {
      this.isCoarse ||= this.budget === MIN_POINTS;
      this.budget = Math.max(MIN_POINTS, 0.8 * this.budget);
    }
    if (took_ms < FAST_MS) {
      this.budget = Math.min(MAX_POINTS, 1.05 * this.budget);
      this.isCoarse &&= this.budget < SHARP_POINTS;
    }
  }

  /** `sharpness`: share of the screen's pixels along each side. */
  private draw(budget: number, sharpness: number): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const ratio = sharpness * Math.min(window.devicePixelRatio, 2);
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
    const { sides } = this;
    this.orbit.resize(width / sides, height);
    const eye = { camera: this.orbit.camera, height_px: height * this.renderer.getPixelRatio() };
    for (const cloud of this.clouds) cloud.choose(eye, budget / sides / this.clouds.length);
    this.drawn = this.clouds.reduce((sum, cloud) => sum + cloud.drawn, 0);
    this.hand.quaternion.copy(this.orbit.camera.quaternion);
    for (let side = 0; side < sides; ++side) {
      this.markers.forEach((markers, i) => {
        markers.group.visible = i === side;
      });
      this.renderer.setViewport((side * width) / sides, 0, width / sides, height);
      this.renderer.setScissor((side * width) / sides, 0, width / sides, height);
      this.renderer.render(this.scene, this.orbit.camera);
    }
    this.onPicture?.();
  }
}

/** Antialiasing is too slow without a GPU. */
function isSoftware(): boolean {
  const context = document.createElement('canvas').getContext('webgl2');
  const names = context?.getExtension('WEBGL_debug_renderer_info');
  const name = names ? (context?.getParameter(names.UNMASKED_RENDERER_WEBGL) as string) : '';
  context?.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|software/i.test(name);
}

const micrometres = (v: number): number => Math.round(1e6 * v);

function look(run: Run): unknown {
  return [
    run.probe_m.map(micrometres),
    run.proxy_m.map(micrometres),
    run.force_N.map((v) => v.toFixed(3)),
    run.in_contact,
    run.linkage.flat().map((point) => point.map(micrometres)),
  ];
}
