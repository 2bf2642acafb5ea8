// Five million points: the page shows a coarse picture at once and never blocks. Times are printed,
// not asserted: they depend on the machine. bench/page_bench reads them.
import assert from 'node:assert/strict';
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { length } from './eye.mjs';
import { folder, launch, openPage, startServer, state, tactree, until } from './setup.mjs';

const COUNT = 5_000_000;
const RADIUS = 0.3;
const FORCE = ['force_x_N', 'force_y_N', 'force_z_N'];
const HEADER = ['ply', 'format binary_little_endian 1.0', `element vertex ${COUNT}`,
  ...['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `property float ${name}`), 'end_header', ''].join('\n');

/** A sphere; the normals give the positions. */
function scan() {
  const values = new Float32Array(6 * COUNT);
  const turn = Math.PI * (3 - Math.sqrt(5));
  for (let i = 0; i < COUNT; ++i) {
    const z = 1 - (2 * (i + 0.5)) / COUNT;
    const level = Math.sqrt(1 - z * z);
    const normal = [level * Math.cos(i * turn), level * Math.sin(i * turn), z];
    normal.forEach((n, k) => {
      values[6 * i + k] = RADIUS * n;
      values[6 * i + 3 + k] = n;
    });
  }
  return Buffer.concat([Buffer.from(HEADER), Buffer.from(values.buffer)]);
}

/** Times between 60 pictures, ms, sorted, while a key turns the view or the pointer goes around a place. */
function gaps(page, { key, around }) {
  return page.evaluate(([pressed, place]) => new Promise((done) => {
    const times = [];
    const canvas = document.getElementById('view');
    const act = () => {
      if (pressed) canvas.dispatchEvent(new KeyboardEvent('keydown', { key: pressed, shiftKey: true }));
      if (!place) return;
      const turn = times.length / 8;
      const [clientX, clientY] = [place[0] + 40 * Math.cos(turn), place[1] + 40 * Math.sin(turn)];
      canvas.dispatchEvent(new PointerEvent('pointermove', { pointerId: 1, clientX, clientY }));
    };
    const next = (now) => {
      times.push(now);
      act();
      if (times.length < 60) requestAnimationFrame(next);
      else done(times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b));
    };
    requestAnimationFrame(next);
  }), [key, around]);
}

const tell = (what, sorted) =>
  console.log(`${what}: ${sorted[30].toFixed(0)} ms a picture, the longest ${sorted.at(-1).toFixed(0)} ms`);

test('five million points', async () => {
  const ply = join(folder, 'large.ply');
  const blob = join(folder, 'large.blob');
  writeFileSync(ply, scan());
  execFileSync(tactree, ['build', ply, '--unit', 'm', '--no-resample', '-o', blob], { stdio: 'pipe' });
  const begin = Date.now();
  const server = await startServer([blob, '--device', 'cartesian']);
  console.log(`server ready after ${Date.now() - begin} ms`);
  const browser = await launch();
  const page = await openPage(browser, server.url);
  const first = await page.evaluate(() => Number(document.documentElement.dataset.firstPicture));
  console.log(`first picture after ${first} ms`);
  assert.match(await page.locator('#model-name').textContent(), /[45],\d{3},\d{3} points/);
  await state(page, 'active');

  // While points still come in, the view turns and the numbers change.
  const box = await page.locator('#view').boundingBox();
  await page.locator('#view').focus();
  tell('turning', await gaps(page, { key: 'ArrowLeft' }));

  // A hand that slides over the surface, with its force and its history.
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await until(page, FORCE, (...force) => length(force) > 0.05, 'no force');
  tell('touching', await gaps(page, { around: [box.x + box.width / 2, box.y + box.height / 2] }));
  const drawn = () => page.locator('#detail').textContent().then((text) => Number(text.replace(/\D/g, '')));
  const moving = await drawn();
  await page.mouse.up();
  await page.waitForFunction((before) =>
    Number(document.getElementById('detail').textContent.replace(/\D/g, '')) > before, moving);
  console.log(`points drawn: ${moving} while touched, ${await drawn()} at rest`);
  assert.ok(moving < COUNT, 'reduced detail');
  await page.keyboard.press('Space');
  await state(page, 'idle');
  assert.deepEqual(page.troubles, []);
  await browser.close();
  await server.stop();
});
