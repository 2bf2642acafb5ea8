// The materials of the model in false colours, and their legend.

import * as THREE from 'three';
import type { Material } from './cloud';
import { find } from './panel';

const MOST = 256;

/** Distinct colours: hues a golden section apart, of two lightnesses. */
function falseColour(index: number): THREE.Color {
  return new THREE.Color().setHSL((0.08 + 0.618034 * index) % 1, 0.65, index % 2 === 0 ? 0.55 : 0.42);
}

/** The colour of each material, as one row of pixels. */
export function paletteOf(count: number): THREE.DataTexture {
  const pixels = new Uint8Array(4 * MOST);
  for (let i = 0; i < Math.min(count, MOST); ++i) {
    const { r, g, b } = falseColour(i);
    pixels.set([255 * r, 255 * g, 255 * b, 255], 4 * i);
  }
  const palette = new THREE.DataTexture(pixels, MOST, 1);
  palette.needsUpdate = true;
  return palette;
}

/** "felt: 200 N/m, friction 0.3 / 0.2 · 1,234 points" */
function describe(material: Material, index: number): string {
  const name = material.name ?? `material ${index}`;
  const friction = `friction ${short(material.static_friction)} / ${short(material.dynamic_friction)}`;
  const texture =
    material.texture_height_m > 0 ? `, texture ${short(1e3 * material.texture_height_m)} mm` : '';
  const points = `${material.points.toLocaleString('en')} points`;
  return `${name}: ${short(material.stiffness_N_m)} N/m, ${friction}${texture} · ${points}`;
}
const short = (value: number): string => String(Number(value.toPrecision(3)));

function swatch(css: string, title: string): HTMLElement {
  const box = document.createElement('i');
  box.style.background = css;
  box.title = title;
  return box;
}

/** Lists the materials beside their false colours, and the colours of the scan that they came from. */
export function showLegend(materials: Material[]): void {
  find('material-list').replaceChildren(
    ...materials.map((material, i) => {
      const row = document.createElement('li');
      row.append(swatch(`#${falseColour(i).getHexString(THREE.LinearSRGBColorSpace)}`, 'on the picture'));
      if (material.rgb) row.append(swatch(`rgb(${material.rgb.join(',')})`, 'in the scan'));
      row.append(describe(material, i));
      return row;
    }),
  );
}
