// What the page says to someone who does not know it: why there is no force, and what does not fit.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { length } from './eye.mjs';
import { bumpySphere, buildModel, folder, launch, number, openPage, startServer, state, tactree, until }
  from './setup.mjs';

const RADIUS = 0.04;
const FORCE = ['force_x_N', 'force_y_N', 'force_z_N'];
const PROBE = ['probe_x_m', 'probe_y_m', 'probe_z_m'];
const blob = buildModel('smooth', bumpySphere(30000, RADIUS, 0), ['--unit', 'm']);
let browser;

before(async () => {
  browser = await launch();
});
after(async () => {
  await browser?.close();
});

async function openSession(t, args = [blob], options = {}) {
  const server = await startServer(args);
  t.after(server.stop);
  const page = await openPage(browser, server.url, options);
  t.after(() => page.close());
  return page;
}

const text = (page, id) => page.locator(`#${id}`).textContent();

async function clickPicture(page) {
  const box = await page.locator('#view').boundingBox();
  await page.mouse.click(box.x + 5, box.y + box.height - 5);
}

/** Sends the commands of a page that this one has no control for. */
const say = (page, command) => page.evaluate((wanted) => new Promise((done) => {
  const socket = new WebSocket(`ws://${location.host}/live`);
  socket.onopen = () => {
    socket.send(JSON.stringify(wanted));
    setTimeout(() => { socket.close(); done(); }, 200);
  };
}), command);

test('a stopped or faulted controller says why there is no force, also to a click', async (t) => {
  const page = await openSession(t);
  await state(page, 'active');
  assert.equal(await text(page, 'why'), '');
  await page.locator('#stop').click();
  await state(page, 'idle');
  assert.equal(await text(page, 'why'), 'stopped: press Arm');
  assert.ok(await page.locator('#note').isHidden());
  await clickPicture(page);
  assert.equal(await text(page, 'note'), 'stopped: press Arm');
  await page.waitForTimeout(1200);
  await page.locator('#arm').click();
  await state(page, 'active');
  await page.locator('#note').waitFor({ state: 'hidden', timeout: 3000 }); // it is no longer true
  await page.locator('#faults summary').click();
  await page.getByRole('button', { name: 'estop:pressed' }).click();
  await state(page, 'fault');
  await clickPicture(page);
  assert.match(await text(page, 'note'), /^No force until the fault is cleared/);
  assert.deepEqual(page.troubles, []);
});

test('a model beyond reach is announced, scaled on demand, and then touched', async (t) => {
  const large = buildModel('large', bumpySphere(30000, 0.5, 0), ['--unit', 'm']);
  const page = await openSession(t, [large]);
  await page.locator('#fit').waitFor();
  assert.match(await text(page, 'fit-warning'), /more than premium reaches.*does not reach the start of the hand/);
  await page.locator('#scale').click();
  await page.locator('#fit').waitFor({ state: 'hidden' });
  await state(page, 'active');
  const before = await number(page, 't_s');
  await until(page, ['t_s', ...PROBE], (t_s, ...at) => t_s < before + 60 && length(at) < 0.4, 'not scaled');
  await page.waitForTimeout(500); // the picture of the new model
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await until(page, FORCE, (...force) => length(force) > 0.1, 'no force');
  await page.mouse.up();
});

/** A half ball, flat side at the lowest z, turned so that its z points along y: rows x y z. */
function lyingDome() {
  const rows = [];
  const turn = Math.PI * (3 - Math.sqrt(5));
  for (let i = 0; i < 12000; ++i) {
    const z = (i + 0.5) / 12000;
    const r = Math.sqrt(1 - z * z);
    rows.push([0.04 * r * Math.cos(i * turn), 0.04 * z, -0.04 * r * Math.sin(i * turn)]);
  }
  for (let i = 0; i < 6000; ++i) {
    const r = 0.04 * Math.sqrt((i + 0.5) / 6000);
    rows.push([r * Math.cos(i * turn), 0, -r * Math.sin(i * turn)]);
  }
  return `${rows.map((row) => row.map((v) => v.toFixed(6)).join(' ')).join('\n')}\n`;
}

test('a model that lies on its side is announced until it is dismissed', async (t) => {
  const page = await openSession(t, [buildModel('lying', lyingDome(), ['--unit', 'm'])]);
  await page.locator('#posture').waitFor();
  assert.match(await text(page, 'posture-note'), /lying: the model seems to lie on its side.*lowest y.*--axis y/);
  await page.locator('#posture-close').click();
  assert.ok(await page.locator('#posture').isHidden());
  await page.close();
  const upright = await openSession(t, [buildModel('upright', lyingDome(), ['--unit', 'm', '--axis', 'y'])]);
  assert.ok(await upright.locator('#posture').isHidden());
  assert.deepEqual([...page.troubles, ...upright.troubles], []);
});

test('the page opens with the front of the model, the side of +x, towards the viewer', async (t) => {
  const page = await openSession(t);
  await state(page, 'active');
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await until(page, FORCE, (...force) => length(force) > 0.1, 'no force');
  // The camera looks down by 0.35 rad at the middle of the ball.
  const [x, y, z] = await until(page, PROBE, () => true, '');
  await page.mouse.up();
  assert.ok(x > 0.85 * RADIUS && Math.abs(y) < 0.1 * RADIUS && z > 0, `touched at ${x}, ${y}, ${z}`);
});

test('the distance has a sign: outside, inside, and behind a sheet', async (t) => {
  const shown = async (page) => parseFloat(await text(page, 'distance'));
  const check = async (page, z_m, heightOf) => {
    await say(page, { do: 'hand', target_m: [0, 0, z_m] });
    await until(page, PROBE, (x, y, z) => Math.abs(z - z_m) < 2e-3, `not at ${z_m}`);
    await page.waitForTimeout(1000); // the device comes to rest
    const exact_mm = 1e3 * heightOf(await until(page, PROBE, () => true, ''));
    const now_mm = await shown(page);
    assert.ok(Math.abs(now_mm - exact_mm) < 0.4, `${now_mm} instead of ${exact_mm} mm`);
  };
  const page = await openSession(t);
  await state(page, 'active');
  await number(page, 't_s');
  await page.locator('#stop').click();
  await state(page, 'idle');
  for (const z of [RADIUS + 0.015, RADIUS - 0.01, 0.5 * RADIUS]) {
    await check(page, z, (probe) => length(probe) - RADIUS);
  }
  const rows = [];
  for (let i = -40; i <= 40; ++i) for (let j = -40; j <= 40; ++j) rows.push(`${i / 1000} ${j / 1000} 0 0 0 1`);
  const sheet = await openSession(t, [buildModel('sheet', `${rows.join('\n')}\n`, ['--unit', 'm'])]);
  await number(sheet, 't_s');
  await sheet.locator('#stop').click();
  await state(sheet, 'idle');
  await check(sheet, -0.012, (probe) => probe[2]);
});

test('no message covers Clear, Arm or another message', async (t) => {
  for (const [width, height] of [[360, 560], [820, 500], [1280, 720]]) {
    const page = await openSession(t, [blob], { viewport: { width, height }, hasTouch: true });
    await state(page, 'active');
    await say(page, { do: 'inject', fault: 'estop:pressed' });
    await state(page, 'fault');
    await clickPicture(page);
    await page.locator('#note').waitFor();
    const covered = await page.evaluate(() => {
      const boxOf = (element) => element.getBoundingClientRect();
      const meet = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
      const all = ['banner', 'model-warning', 'board-gone', 'offline', 'fit', 'posture', 'inside', 'confirm', 'note',
        'panel']
        .map((id) => document.getElementById(id)).filter((one) => one.offsetParent);
      return ['clear', 'arm'].flatMap((id) => {
        const button = document.getElementById(id);
        return all.filter((one) => !one.contains(button) && meet(boxOf(one), boxOf(button)))
          .map((one) => `${one.id} covers ${id}`);
      });
    });
    assert.deepEqual(covered, [], `${width} x ${height}`);
  }
});

test('on a small screen every button of many messages can be pressed', async (t) => {
  const large = buildModel('large', bumpySphere(30000, 0.5, 0), ['--unit', 'm']);
  const page = await openSession(t, [large], { viewport: { width: 360, height: 560 }, hasTouch: true });
  await say(page, { do: 'inject', fault: 'estop:pressed' });
  await state(page, 'fault');
  await clickPicture(page);
  await page.locator('#note').waitFor();
  await page.locator('#fit').waitFor();
  for (const id of ['clear', 'scale']) await page.locator(`#${id}`).click({ timeout: 5000 });
  await page.locator('#fit').waitFor({ state: 'hidden' });
});

test('rows appear where they mean something; deadlines and a slow computer are not confused', async (t) => {
  const page = await openSession(t);
  await state(page, 'active');
  for (const id of ['mode', 'device']) assert.ok(await page.locator(`#${id}`).isVisible(), id);
  assert.ok(await page.locator('#work').isHidden(), 'an empty row of instructions');
  assert.match(await text(page, 'timing'), /^1000 ticks\/s · 0 deadlines missed by the simulated board/);
  await say(page, { do: 'inject', fault: 'loop:overrun=2' });
  await page.waitForFunction(() => / [1-9] deadlines missed by the simulated board/.test(
    document.getElementById('timing').textContent));

  const csv = join(folder, 'rows.csv');
  execFileSync(tactree, ['simulate', blob, '--seconds', '1', '--trace', csv], { stdio: 'pipe' });
  const replay = await openSession(t, [blob, '--trace', csv]);
  for (const id of ['mode', 'device', 'work']) assert.ok(await replay.locator(`#${id}`).isHidden(), id);
});

test('a computer that is too slow says how much it skipped', async (t) => {
  const server = await startServer([blob]);
  t.after(server.stop);
  const page = await browser.newPage();
  t.after(() => page.close());
  await page.routeWebSocket(/live/, (socket) => {
    const to = socket.connectToServer();
    to.onMessage((message) => {
      const frame = JSON.parse(message);
      socket.send(JSON.stringify(frame.type === 'frame' ? { ...frame, lost_s: 2.5 } : frame));
    });
  });
  await page.goto(server.url);
  await page.waitForFunction(() => /this computer is too slow: 2\.5 s skipped/.test(
    document.getElementById('timing').textContent), null, { timeout: 60000 });
});
