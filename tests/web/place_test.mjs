// Placing the model: by numbers and by a handle, while the simulation runs; its size; the saved pose.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { length, pixelOf } from './eye.mjs';
import { bumpySphere, buildModel, folder, launch, number, openPage, startServer, state, tactree, until }
  from './setup.mjs';

const RADIUS = 0.03;
const FORCE = ['force_x_N', 'force_y_N', 'force_z_N'];
const PROBE = ['probe_x_m', 'probe_y_m', 'probe_z_m'];
const blob = buildModel('placed', bumpySphere(20000, RADIUS, 0), ['--unit', 'm']);
let browser;

before(async () => {
  browser = await launch();
});
after(async () => {
  await browser?.close();
});

async function openPlaced(t, args = []) {
  const server = await startServer([blob, ...args]);
  t.after(server.stop);
  const page = await openPage(browser, server.url);
  t.after(() => page.close());
  await state(page, 'active');
  await page.locator('#place summary').click();
  return page;
}

/** Types a number as a user does. */
async function type(page, name, value) {
  await page.locator(`#place-${name}`).fill(String(value));
  await page.locator(`#place-${name}`).press('Tab');
}

const value = async (page, name) => Number(await page.locator(`#place-${name}`).inputValue());

/** The pose file that the page saves; `file`: its copy. */
async function savedPose(page, file = join(folder, 'saved.json')) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#place-save').click()]);
  assert.equal(download.suggestedFilename(), 'pose.json');
  await download.saveAs(file);
  return JSON.parse(readFileSync(file, 'utf8'));
}

/** Waits until the server says this pose. */
const placedAt = (page, name, wanted, off = 0.02) => page.waitForFunction(([id, goal, tolerance]) => {
  const field = document.getElementById(`place-${id}`);
  return document.activeElement !== field && Math.abs(Number(field.value) - goal) < tolerance;
}, [name, wanted, off]);

async function pressAt(page, place) {
  const box = await page.locator('#view').boundingBox();
  const at = await pixelOf(page, place);
  await page.mouse.move(box.x + at.x, box.y + at.y);
  await page.mouse.down();
  await until(page, FORCE, (...force) => length(force) > 0.1, 'no force');
}

test('a model placed by numbers is touched there, and the session goes on', async (t) => {
  const page = await openPlaced(t);
  const before_s = await number(page, 't_s');
  await type(page, 'y', 25);
  await placedAt(page, 'y', 25);
  await type(page, 'turn-z', 90);
  await placedAt(page, 'turn-z', 90);
  assert.ok(await page.locator('#place-ask').isHidden());
  await page.locator('#place summary').click(); // without handles over the model
  await pressAt(page, [0, 0.025, 0]);
  const [, y] = await until(page, PROBE, () => true, '');
  await page.mouse.up();
  assert.ok(Math.abs(y - 0.025) < 0.01, `touched at y = ${y}`);
  assert.ok(await number(page, 't_s') > before_s);
  assert.deepEqual(page.troubles, []);
});

test('typed angles stay as they were typed, and a size that is none is refused', async (t) => {
  const page = await openPlaced(t);
  await type(page, 'turn-x', 30);
  await type(page, 'turn-y', 120); // the same turn as 180 + 30, 60, 180
  await page.waitForTimeout(1000);
  for (const [name, to] of [['turn-x', 30], ['turn-y', 120], ['turn-z', 0]]) {
    assert.equal(await value(page, name), to, name);
  }
  const { pose } = await savedPose(page);
  const radians = Math.PI / 180; // about x, then y: the rotated z axis
  const axis = [Math.sin(120 * radians) * Math.cos(30 * radians), -Math.sin(30 * radians),
    Math.cos(120 * radians) * Math.cos(30 * radians)];
  axis.forEach((v, i) => assert.ok(Math.abs(pose[4 * i + 2] - v) < 1e-4, `${pose}`));
  for (const size of ['-5', '']) {
    await type(page, 'size', size);
    await page.waitForFunction(() => /^Size: /.test(document.getElementById('note').textContent));
    await placedAt(page, 'size', 100);
    await page.evaluate(() => { document.getElementById('note').textContent = ''; });
  }
  await placedAt(page, 'turn-y', 120);
  assert.deepEqual(page.troubles, []);
});

test('the handle along y moves the model to the right', async (t) => {
  const page = await openPlaced(t);
  const box = await page.locator('#view').boundingBox();
  // The arrow takes 0.14 of the height of the picture, and is seen at a right angle.
  const centre = await pixelOf(page, [0, 0, 0]);
  const arrow = { x: centre.x + 0.08 * box.height, y: centre.y };
  await page.mouse.move(box.x + arrow.x, box.y + arrow.y);
  await page.mouse.down();
  await page.mouse.move(box.x + arrow.x + 60, box.y + arrow.y, { steps: 6 });
  const shown = await value(page, 'y');
  await page.mouse.up();
  const pixels = (await pixelOf(page, [0, 0.01, 0])).x - centre.x; // of 10 mm
  assert.ok(Math.abs(shown - (10 * 60) / pixels) < 1.5, `${shown} mm after 60 pixels, 10 mm are ${pixels}`);
  await placedAt(page, 'y', shown);
  for (const name of ['x', 'z', 'turn-x', 'turn-y', 'turn-z']) {
    assert.ok(Math.abs(await value(page, name)) < 0.1, name);
  }
  assert.equal(await page.locator('#state').textContent(), 'active');
  assert.deepEqual(page.troubles, []);
});

test('another size asks, and restarts only when it is confirmed', async (t) => {
  const page = await openPlaced(t);
  const before_s = await number(page, 't_s');
  await type(page, 'size', 150);
  await page.locator('#place-ask').waitFor();
  assert.match(await page.locator('#place-ask-text').textContent(), /^Size 150\.0 %: the simulation restarts/);
  await page.locator('#place-cancel').click();
  await placedAt(page, 'size', 100);
  assert.ok(await number(page, 't_s') > before_s);
  await type(page, 'size', 150);
  await page.locator('#place-restart').click();
  await placedAt(page, 'size', 150);
  await page.waitForFunction(async (edge) => {
    const tree = await (await fetch('/model/0')).json();
    return tree.bounds_max_m[2] - tree.bounds_min_m[2] > edge;
  }, 2.9 * RADIUS);
  await state(page, 'active');
});

test('a saved pose places the model in every command', async (t) => {
  const page = await openPlaced(t);
  for (const [name, to] of [['x', 10], ['y', -20], ['z', 5], ['turn-x', 30], ['turn-y', -40], ['turn-z', 100]]) {
    await type(page, name, to);
    await placedAt(page, name, to);
  }
  const file = join(folder, 'pose.json');
  const { pose, scale } = await savedPose(page, file);
  assert.equal(scale, 1);
  assert.equal(pose.length, 16);
  const trace = join(folder, 'posed.csv');
  execFileSync(tactree, ['simulate', blob, '--pose', file, '--script', 'press', '--seconds', '1', '--trace', trace],
    { stdio: 'pipe' });
  const again = await openPlaced(t, ['--pose', file]);
  for (const [name, to] of [['x', 10], ['y', -20], ['z', 5], ['turn-x', 30], ['turn-y', -40], ['turn-z', 100]]) {
    await placedAt(again, name, to, 0.2);
  }
  await again.locator('#place-reset').click();
  await placedAt(again, 'x', 0);
  await placedAt(again, 'turn-y', 0);
});

for (const device of ['premium', 'pantograph', 'hapkit']) {
  test(`the reach of a ${device} is drawn while the model is placed`, async (t) => {
    const page = await openPlaced(t, ['--device', device]);
    await page.locator('#legend-reach').waitFor();
    const reach = await page.evaluate(async () => (await fetch('/reach.json')).json());
    assert.ok(reach.columns > 0);
    assert.equal(reach.points_m.length, reach.rows * reach.columns);
    await page.locator('#place summary').click();
    await page.locator('#legend-reach').waitFor({ state: 'hidden' });
    assert.deepEqual(page.troubles, []);
  });
}

test('a scene cannot be placed, and two pictures have no handles', async (t) => {
  const server = await startServer([blob, blob]);
  t.after(server.stop);
  const scene = await openPage(browser, server.url);
  t.after(() => scene.close());
  await state(scene, 'active');
  assert.ok(await scene.locator('#place').isHidden());
  const page = await openPlaced(t, ['--mode', 'both']);
  await page.locator('#place-sides').waitFor();
  await type(page, 'y', 15);
  await placedAt(page, 'y', 15);
});
