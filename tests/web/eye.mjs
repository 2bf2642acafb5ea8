// The camera of the page, computed apart from the page: where the line of sight through a pixel meets
// a ball, and how much of the picture the model covers.

const FIELD = (35 * Math.PI) / 180;
const CLOSE = 1.05; // of the distance at which the ball around the model fills the picture
const START = { yaw: 0, pitch: 0.35 };

const add = (a, b, factor = 1) => a.map((x, i) => x + factor * b[i]);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(...a);
export const distance = (a, b) => length(add(a, b, -1));

/** The camera after the page has loaded, then turned by these angles. */
async function camera(page, turned) {
  const { tree, width, height } = await page.evaluate(async () => {
    const canvas = document.getElementById('view');
    return {
      tree: await (await fetch('/model/0')).json(), width: canvas.clientWidth, height: canvas.clientHeight,
    };
  });
  const [low, high] = [tree.bounds_min_m, tree.bounds_max_m];
  const centre = low.map((v, i) => (v + high[i]) / 2);
  const away = (CLOSE * distance(low, high)) / 2 / Math.sin(FIELD / 2) / Math.min(1, width / height);
  const yaw = START.yaw + (turned.yaw ?? 0);
  const pitch = START.pitch + (turned.pitch ?? 0);
  const back = [Math.cos(pitch) * Math.cos(yaw), Math.cos(pitch) * Math.sin(yaw), Math.sin(pitch)];
  const level = [-Math.sin(yaw), Math.cos(yaw), 0];
  const [c, s] = [Math.cos(turned.roll ?? 0), Math.sin(turned.roll ?? 0)];
  const right = add(level.map((v) => c * v), cross(back, level), s);
  const unit = (2 * Math.tan(FIELD / 2)) / height; // of a pixel, at a distance of 1
  return { at: add(centre, back, away), back, right, up: cross(back, right), unit, width, height };
}

/** Place of a ball of this radius, with its middle at the origin, under a pixel of the canvas. */
export async function ballAt(page, radius, x, y, turned = {}) {
  const { at, back, right, up, unit, width, height } = await camera(page, turned);
  let ray = add(add(back.map((v) => -v), right, (x - width / 2) * unit), up, (height / 2 - y) * unit);
  ray = ray.map((v) => v / length(ray));
  const along = dot(at, ray);
  const inside = along ** 2 - dot(at, at) + radius ** 2;
  if (inside < 0) throw new Error(`no ball under the pixel ${x}, ${y}`);
  return add(at, ray, -along - Math.sqrt(inside));
}

/** Pixel of the canvas that shows a place. */
export async function pixelOf(page, place) {
  const { at, back, right, up, unit, width, height } = await camera(page, {});
  const offset = add(place, at, -1);
  const deep = -dot(offset, back) * unit;
  return { x: width / 2 + dot(offset, right) / deep, y: height / 2 - dot(offset, up) / deep };
}

/** Share of the canvas that is not background, and the middle of that part, in shares of the canvas. */
export async function covered(page) {
  const hide = await page.addStyleTag({ content: '#legend, #alerts { visibility: hidden !important; }' });
  const png = await page.locator('#view').screenshot();
  await hide.evaluate((style) => style.remove());
  return page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const { width, height } = picture;
    const context = new OffscreenCanvas(width, height).getContext('2d');
    context.drawImage(picture, 0, 0);
    const { data } = context.getImageData(0, 0, width, height);
    const ground = 4 * (width * Math.floor(height / 2) + 5);
    let [count, x, y] = [0, 0, 0];
    for (let i = 0; i < data.length; i += 4) {
      const differs = [0, 1, 2].some((k) => Math.abs(data[i + k] - data[ground + k]) > 12);
      if (!differs) continue;
      count += 1;
      x += (i / 4) % width;
      y += Math.floor(i / 4 / width);
    }
    return { share: count / width / height, x: x / count / width, y: y / count / height };
  }, png.toString('base64'));
}
