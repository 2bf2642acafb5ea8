// Touch with mouse and fingers on the picture of the object, and the view's own motions.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { ballAt, covered, distance, length, pixelOf } from './eye.mjs';
import { bumpySphere, buildModel, launch, number, openPage, startServer, state, until } from './setup.mjs';

const RADIUS = 0.04;
const UNDER_CURSOR_M = 0.002;
const KEY_TURN = 0.08; // of a press of Shift and an arrow key
const FORCE = ['force_x_N', 'force_y_N', 'force_z_N'];
const PROBE = ['probe_x_m', 'probe_y_m', 'probe_z_m'];
const PROXY = ['proxy_x_m', 'proxy_y_m', 'proxy_z_m'];
const blob = buildModel('smooth', bumpySphere(30000, RADIUS, 0), ['--unit', 'm']);
let browser;
let server;

before(async () => {
  browser = await launch();
});
after(async () => {
  await browser?.close();
});

/** A page with a session of its own. */
async function openSession(t, options = {}, args = []) {
  server = await startServer([blob, ...args]);
  t.after(server.stop);
  const page = await openPage(browser, server.url, options);
  t.after(() => page.close());
  await state(page, 'active');
  await number(page, 't_s'); // opens the table
  return page;
}

/** A place of the canvas: shares of its height from the middle. */
async function pixel(page, right, up) {
  const box = await page.locator('#view').boundingBox();
  const at = { x: box.width / 2 + right * box.height, y: box.height / 2 - up * box.height };
  return { ...at, pageX: box.x + at.x, pageY: box.y + at.y };
}

/** Waits until the proxy is at the place, on the surface, with a force. */
async function touches(page, place, what) {
  const values = await until(page, [...PROXY, ...FORCE, 'penetration_m'], (x, y, z, fx, fy, fz, deep) =>
    deep > 0 && length([fx, fy, fz]) > 0.1 && distance([x, y, z], place) < UNDER_CURSOR_M, what);
  const from_m = Math.abs(length(values.slice(0, 3)) - RADIUS);
  assert.ok(from_m < 3e-4, `the proxy is ${from_m} m from the surface`);
  return values;
}

async function pressAt(page, right, up, turned) {
  const at = await pixel(page, right, up);
  await page.mouse.move(at.pageX, at.pageY);
  await page.mouse.down();
  const place = await ballAt(page, RADIUS, at.x, at.y, turned);
  await touches(page, place, `no touch at ${place}`);
}

/** Waits until the hand has come to rest in the object; the penetration then, m. */
async function depthAtRest(page) {
  let before = { t_s: -1, deep_m: 0 };
  const [, deep_m] = await until(page, ['t_s', 'penetration_m'], (t_s, now_m) => {
    if (t_s < before.t_s + 0.1) return false;
    const still = now_m > 0 && Math.abs(now_m - before.deep_m) < 0.02 * now_m;
    before = { t_s, deep_m: now_m };
    return still;
  }, 'the hand does not come to rest');
  return deep_m;
}

/** Waits until what the model covers of the picture holds. */
async function untilCovered(page, holds, what) {
  const limit = Date.now() + 60000;
  let now = await covered(page);
  while (!holds(now)) {
    assert.ok(Date.now() < limit, `${what}: ${JSON.stringify(now)}`);
    await page.waitForTimeout(100);
    now = await covered(page);
  }
  return now;
}

/** What the model covers once the picture stands still. */
async function coveredAtRest(page) {
  let before = { share: -1 };
  return untilCovered(page, (now) => {
    const still = now.share === before.share;
    before = now;
    return still;
  }, 'the picture does not come to rest');
}

const distanceText = (page) => page.locator('#distance').textContent();

const untilText = (page, pattern) => page.waitForFunction(
  (text) => new RegExp(text).test(document.getElementById('distance').textContent), pattern.source,
  { timeout: 60000 });

test('pressing on the picture touches the surface under the cursor; dragging slides along it', async (t) => {
  const page = await openSession(t);
  await pressAt(page, 0.1, 0.12);
  for (const [right, up] of [[0.16, 0.02], [0.02, -0.1], [-0.17, 0.05]]) {
    const at = await pixel(page, right, up);
    await page.mouse.move(at.pageX, at.pageY, { steps: 6 });
    await touches(page, await ballAt(page, RADIUS, at.x, at.y), `the proxy does not follow to ${right}, ${up}`);
  }
  await page.mouse.up();
  await until(page, [...PROBE, ...FORCE], (x, y, z, ...f) => length([x, y, z]) > RADIUS + 0.005 && length(f) === 0,
    'the hand does not withdraw');
  assert.deepEqual(page.troubles, []);
});

test('the hand slides over the whole path of a fast drag without leaving the surface', async (t) => {
  const page = await openSession(t);
  await pressAt(page, -0.2, 0);
  const begin_s = await number(page, 't_s');
  const to = await pixel(page, 0.2, 0);
  await page.mouse.move(to.pageX, to.pageY);
  await touches(page, await ballAt(page, RADIUS, to.x, to.y), 'the proxy does not follow');
  await page.mouse.up();
  await until(page, ['penetration_m'], (deep) => deep <= 0, 'the hand stays in the object');
  const csv = await (await fetch(`${server.url}trace.csv`)).text();
  const [heading, ...rows] = csv.trim().split('\n').map((row) => row.split(','));
  const column = (row, name) => Number(row[heading.indexOf(name)]);
  // Until the hand left: what the page shows is older than the session on a busy machine.
  const slid = rows.filter((row) => column(row, 't_s') > begin_s);
  while (slid.length > 0 && column(slid.at(-1), 'in_contact') === 0) slid.pop();
  assert.ok(slid.length > 100, `${slid.length} ticks`);
  const free = slid.filter((row) => column(row, 'in_contact') === 0).length;
  assert.ok(free < 0.05 * slid.length, `${free} of ${slid.length} ticks without contact`);
});

test('the wheel changes the depth while pressed, and zooms otherwise', async (t) => {
  const page = await openSession(t);
  await page.locator('#show-device').uncheck();
  await pressAt(page, 0, 0.1);
  const deep = await depthAtRest(page);
  await page.mouse.wheel(0, -100);
  await page.mouse.wheel(0, -300); // three notches in one event, as a busy page gets them
  await until(page, ['penetration_m'], (now) => now > 1.5 * deep, 'not deeper');
  await untilText(page, /in contact · hand 8\.0 mm deep/);
  for (let i = 0; i < 6; ++i) await page.mouse.wheel(0, 100);
  await until(page, ['penetration_m'], (now) => now < 0.8 * deep, 'not shallower');
  await page.mouse.up();
  await until(page, ['penetration_m'], (now) => now === 0, 'the hand does not withdraw');
  const before = await coveredAtRest(page);
  for (let i = 0; i < 5; ++i) await page.mouse.wheel(0, 100);
  await untilCovered(page, (now) => now.share < 0.7 * before.share, `no smaller than ${before.share}`);
});

test('a slider changes the force under the pressing hand, without a jump or a lost tick', async (t) => {
  const page = await openSession(t);
  await pressAt(page, 0, 0.1);
  const deep = await depthAtRest(page);
  const [begin_s, ...before] = await until(page, ['t_s', ...FORCE], () => true, '');
  await page.locator('#stiffness_N_m').focus();
  for (let i = 0; i < 30; ++i) await page.keyboard.press('ArrowRight');
  await until(page, ['penetration_m', ...FORCE], (now, ...force) =>
    now > 0 && now < 0.9 * deep && length(force) > 1.05 * length(before), 'the change is not felt');
  assert.equal(await page.locator('#stiffness_N_m').inputValue(), '800');
  const [end_s] = await until(page, ['t_s'], (t_s) => t_s > begin_s + 1, 'the session does not go on');
  await page.waitForTimeout(1000); // the last ticks are missing in a trace
  const csv = await (await fetch(`${server.url}trace.csv`)).text();
  const [heading, ...rows] = csv.trim().split('\n').map((row) => row.split(','));
  const column = (row, name) => Number(row[heading.indexOf(name)]);
  assert.equal(column(rows[0], 't_s'), 0, 'recorded ticks are lost');
  const felt = rows.filter((row) => column(row, 't_s') > begin_s && column(row, 't_s') < end_s);
  assert.ok(felt.length > 500, `${felt.length} ticks`);
  const forces = felt.map((row) => length(FORCE.map((name) => column(row, name))));
  const steps = forces.slice(1).map((force, i) => Math.abs(force - forces[i]));
  assert.ok(felt.every((row) => column(row, 'in_contact') === 1), 'the hand lost the surface');
  assert.ok(Math.max(...steps) < 0.1 * length(before), `a jump of ${Math.max(...steps)} N`);
  await page.mouse.up();
  assert.deepEqual(page.troubles, []);
});

test('the far side is touched after turning the view, and the hand comes back around the object', async (t) => {
  const page = await openSession(t);
  const start = await until(page, PROBE, () => true, '');
  await page.locator('#view').focus();
  const turns = Math.round(Math.PI / KEY_TURN);
  for (let i = 0; i < turns; ++i) await page.keyboard.press('Shift+ArrowLeft');
  await pressAt(page, 0.05, -0.15, { yaw: turns * KEY_TURN });
  await page.mouse.up();
  const [begin_s] = await until(page, ['t_s', 'penetration_m'], (t_s, deep) => deep <= 0, 'the hand stays in the object');
  await page.locator('#hand-back').click();
  await until(page, PROBE, (...at) => distance(at, start) < 0.002, 'the hand does not come back');
  const csv = await (await fetch(`${server.url}trace.csv`)).text();
  const [heading, ...rows] = csv.trim().split('\n').map((row) => row.split(','));
  const later = rows.filter((row) => Number(row[0]) > begin_s);
  const touching = later.filter((row) => row[heading.indexOf('in_contact')] !== '0').length;
  assert.equal(touching, 0, 'the hand came back through the object');
});

test('the view turns over the poles and rolls; the cursor still touches what it points at', async (t) => {
  const page = await openSession(t);
  await page.locator('#view').focus();
  const turns = 30; // the camera is behind the object, upside down
  for (let i = 0; i < turns; ++i) await page.keyboard.press('Shift+ArrowDown');
  await pressAt(page, 0.12, 0.05, { pitch: turns * KEY_TURN });
  await page.mouse.up();
  for (let i = 0; i < 10; ++i) await page.keyboard.press(']');
  await pressAt(page, 0.05, 0.15, { pitch: turns * KEY_TURN, roll: 10 * KEY_TURN });
  await page.mouse.up();
});

test('dragging beside the object turns the view; with Shift it pans', async (t) => {
  const page = await openSession(t);
  await page.locator('#show-device').uncheck();
  const beside = await pixel(page, -0.75, 0);
  const drag = async (right) => {
    await page.mouse.move(beside.pageX, beside.pageY);
    await page.mouse.down();
    await page.mouse.move(beside.pageX + right, beside.pageY, { steps: 4 });
    await page.mouse.up();
  };
  const before = await coveredAtRest(page);
  const turn_px = 100;
  await drag(turn_px);
  await pressAt(page, 0.1, 0, { yaw: -turn_px * 0.006 });
  await page.mouse.up();
  await page.waitForTimeout(500);
  await page.keyboard.down('Shift');
  await drag(120);
  await page.keyboard.up('Shift');
  const { width } = await page.locator('#view').boundingBox();
  await untilCovered(page, (now) => Math.abs((now.x - before.x) * width - 120) < 30,
    `not 120 of ${width} pixels from ${before.x}`);
});

test('the marker of the hand can be dragged beside the object', async (t) => {
  const page = await openSession(t);
  const start = await until(page, PROBE, () => true, '');
  const box = await page.locator('#view').boundingBox();
  const at = await pixelOf(page, start);
  await page.mouse.move(box.x + at.x, box.y + at.y);
  await page.mouse.down();
  await page.mouse.move(box.x + at.x + 100, box.y + at.y, { steps: 5 });
  await page.mouse.up();
  const now = await until(page, PROBE, (...probe) => distance(probe, start) > 0.005, 'the hand does not move');
  const limit = Date.now() + 60000;
  let shown = at;
  while (Math.hypot(shown.x - at.x - 100, shown.y - at.y) >= 8) {
    assert.ok(Date.now() < limit, `${now}: at ${shown.x - at.x}, ${shown.y - at.y}`);
    shown = await pixelOf(page, await until(page, PROBE, () => true, ''));
  }
});

test('a spot marks the surface under the probe, and its distance is shown', async (t) => {
  const page = await openSession(t);
  await untilText(page, /mm to the surface/);
  const [x, y, z] = await until(page, PROBE, () => true, '');
  const shown_mm = parseFloat(await distanceText(page));
  assert.ok(Math.abs(shown_mm - 1e3 * (length([x, y, z]) - RADIUS)) < 0.3, `${shown_mm} mm`);
});

test('fingers: one touches, a second one sets the depth, two move the view', async (t) => {
  const page = await openSession(t, { viewport: { width: 820, height: 1180 }, hasTouch: true });
  const fingers = await page.context().newCDPSession(page);
  const point = (type, ...places) => fingers.send('Input.dispatchTouchEvent', {
    type, touchPoints: places.map(([x, y], id) => ({ x, y, id })),
  });
  const on = await pixel(page, 0, 0.05);
  const first = [on.pageX, on.pageY];
  await point('touchStart', first);
  await touches(page, await ballAt(page, RADIUS, on.x, on.y), 'no touch by a finger');
  const deep = await depthAtRest(page);
  const second = [on.pageX + 200, on.pageY];
  await point('touchStart', first, second);
  for (let i = 1; i <= 5; ++i) await point('touchMove', first, [second[0], second[1] - 20 * i]);
  await until(page, ['penetration_m'], (now) => now > 1.5 * deep, 'the second finger does not press deeper');
  await point('touchEnd');
  await until(page, ['penetration_m'], (now) => now === 0, 'the hand does not withdraw');

  await page.locator('#show-device').evaluate((box) => box.click());
  const before = await coveredAtRest(page);
  // At once, not one after the other has been handled: the pause between them decides.
  await Promise.all([point('touchStart', first), point('touchStart', first, [first[0] + 100, first[1]])]);
  for (let i = 1; i <= 10; ++i) await point('touchMove', [first[0] - 2 * i, first[1] - 10 * i],
    [first[0] + 100 + 2 * i, first[1] - 10 * i]);
  await point('touchEnd');
  await untilCovered(page, (now) => now.share > 1.4 * before.share && now.y < before.y - 0.03,
    `neither larger nor higher than ${JSON.stringify(before)}`);
  assert.deepEqual(page.troubles, []);
});
