// The page of `tactree view` in a browser.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { inflateSync } from 'node:zlib';
import { bumpySphere, buildModel, folder, launch, number, openPage, shown, startServer, state, tactree, until }
  from './setup.mjs';

const RADIUS = 0.04;
const blob = buildModel('ball', bumpySphere(30000, RADIUS, 0), ['--unit', 'm']);
let browser;
let server;

before(async () => {
  browser = await launch();
  server = await startServer([blob]);
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

/** Number of colours in a PNG file, and the share of pixels not of the most common colour. */
function pixels(png) {
  const width = png.readUInt32BE(16);
  const channels = png[25] === 6 ? 4 : 3;
  const parts = [];
  for (let at = 8; at < png.length;) {
    const size = png.readUInt32BE(at);
    if (png.toString('latin1', at + 4, at + 8) === 'IDAT') parts.push(png.subarray(at + 8, at + 8 + size));
    at += size + 12;
  }
  const raw = inflateSync(Buffer.concat(parts));
  const stride = width * channels + 1;
  const rows = raw.length / stride;
  const counts = new Map();
  let above = Buffer.alloc(stride);
  for (let row = 0; row < rows; ++row) {
    const line = Buffer.from(raw.subarray(row * stride, (row + 1) * stride));
    for (let i = 1; i < stride; ++i) {
      const left = i > channels ? line[i - channels] : 0;
      const corner = i > channels ? above[i - channels] : 0;
      const up = above[i];
      const estimate = left + up - corner;
      const [dl, du, dc] = [left, up, corner].map((v) => Math.abs(estimate - v));
      const paeth = dl <= du && dl <= dc ? left : du <= dc ? up : corner;
      line[i] += [0, left, up, (left + up) >> 1, paeth][line[0]];
    }
    for (let i = 1; i + 2 < stride; i += channels) {
      const key = line[i] << 16 | line[i + 1] << 8 | line[i + 2];
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    above = line;
  }
  const all = [...counts.values()].reduce((a, b) => a + b, 0);
  return { colours: counts.size, drawn: 1 - Math.max(...counts.values()) / all };
}

/** Moves the hand into the surface with the keys of the page. */
async function press(page, wanted_m) {
  await page.locator('#view').focus();
  for (let i = 0; i < 200; ++i) {
    if (await number(page, 'penetration_m') > wanted_m) return;
    // The hand starts above the object.
    await page.keyboard.press(i < 1 ? 'Home' : 'ArrowDown');
    await page.waitForTimeout(60);
  }
  throw new Error('the hand did not reach the surface');
}

/** Waits for this message of the page. */
const noted = (page, wanted) => page.locator('#note', { hasText: wanted }).waitFor({ timeout: 60000 });

test('shows the model and loads no external resources', async () => {
  const page = await openPage(browser, server.url);
  await page.locator('#show-device').uncheck();
  const picture = pixels(await page.locator('#view').screenshot());
  assert.ok(picture.colours > 100, `only ${picture.colours} colours`);
  assert.ok(picture.drawn > 0.05 && picture.drawn < 0.9, `share ${picture.drawn}`);
  assert.match(await page.locator('#model-name').textContent(), /ball/);
  assert.deepEqual(page.foreign, []);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('a press on the object raises the force, with the proxy on the surface, until stop', async () => {
  const page = await openPage(browser, server.url);
  await state(page, 'active');
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await until(page, ['penetration_m'], (deep) => deep >= 0.001, 'the probe does not go in');
  const names = ['proxy', 'probe'].flatMap((n) => ['x', 'y', 'z'].map((axis) => `${n}_${axis}_m`));
  const v = await until(page, names, () => true, '');
  assert.ok(Math.abs(Math.hypot(...v.slice(0, 3)) - RADIUS) < 2e-4, `proxy at ${Math.hypot(...v.slice(0, 3))}`);
  assert.ok(Math.hypot(...v.slice(3)) < RADIUS - 5e-4, `probe at ${Math.hypot(...v.slice(3))}`);
  const force = await until(page, ['force_x_N', 'force_y_N', 'force_z_N'], (...f) => Math.hypot(...f) > 0.3,
    'no force');
  assert.ok(Math.hypot(...force) < 9);
  assert.ok(parseFloat(await page.locator('#force-now').textContent()) > 0.3);

  await page.locator('#stiffness_N_m').focus(); // a control in focus must not keep the key
  await page.keyboard.press('Space');
  await state(page, 'idle');
  await until(page, ['force_x_N', 'force_y_N', 'force_z_N'], (...f) => Math.hypot(...f) === 0, 'still force');
  await page.mouse.up();
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('can be operated by keys alone', async () => {
  const page = await openPage(browser, server.url);
  await page.keyboard.press('Escape');
  await state(page, 'idle');
  await page.locator('#view').focus();
  await page.keyboard.press('Backspace'); // above the object
  await page.waitForTimeout(2000);
  await page.keyboard.press('a');
  await state(page, 'active');
  await press(page, 0.0005);
  await page.keyboard.press('Escape');
  await state(page, 'idle');
  await page.close();
});

test('an injected fault is reported, explained by its page, and cleared', async () => {
  const page = await openPage(browser, server.url);
  await page.locator('#view').focus();
  for (let i = 0; i < 80; ++i) await page.keyboard.press('ArrowUp');
  await page.locator('#arm').click();
  await state(page, 'active');
  await page.locator('#faults summary').click();
  await page.getByRole('button', { name: 'encoder1:disconnected' }).click();
  await state(page, 'fault');
  assert.match(await page.locator('#fault-names').textContent(), /encoder-invalid/);
  const [explained] = await Promise.all([page.context().waitForEvent('page'), page.locator('#fault-page').click()]);
  await explained.waitForLoadState();
  assert.match(await explained.locator('h1').textContent(), /encoder-invalid/);
  assert.ok(await explained.locator('li').count() > 0);
  await explained.close();
  await page.locator('#clear').click();
  await noted(page, /Not cleared: the cause of encoder-invalid persists.* encoder1:disconnected/);
  assert.equal(await page.locator('#state').textContent(), 'fault', 'its cause persists');
  await page.locator('#arm').click();
  await noted(page, /Not armed: the fault encoder-invalid is latched/);
  await page.locator('#clear-injections').click();
  await page.locator('#clear').click();
  await state(page, 'idle');
  await page.close();
});

test('an injected fault without a visible effect is reported with the reason', async () => {
  const own = await startServer([blob]);
  const page = await openPage(browser, own.url);
  await state(page, 'active');
  await page.locator('#faults summary').click();
  await page.getByRole('button', { name: 'motor1:reversed' }).click();
  await noted(page, /motor1:reversed is injected, but has no visible effect yet: it becomes visible in contact/);
  await page.close();
  await own.stop();
});

test('the strips have a time axis: seconds before now, and seconds of a trace', async () => {
  const csv = join(folder, 'axis.csv');
  execFileSync(tactree, ['simulate', blob, '--seconds', '1', '--script', 'rub', '--trace', csv], { stdio: 'pipe' });
  const replay = await startServer([blob, '--trace', csv]);
  for (const [url, first, last] of [[server.url, /^-\d+ s$/, /^now$/], [replay.url, /^0 s$/, /^0\.[89]\d* s|1 s$/]]) {
    const page = await browser.newPage();
    await page.addInitScript(() => {
      window.written = [];
      const { fillText } = CanvasRenderingContext2D.prototype;
      CanvasRenderingContext2D.prototype.fillText = function write(text, x, y) {
        if (this.canvas.id === 'strip-force') window.written.push({ text, x: x / this.canvas.width, y: y / this.canvas.height });
        fillText.call(this, text, x, y);
      };
    });
    await page.goto(url);
    await shown(page);
    await page.waitForTimeout(1000);
    const written = await page.evaluate(() => {
      window.written.length = 0;
      return new Promise((done) => setTimeout(() => done(window.written), 500));
    });
    const axis = written.filter(({ text, y }) => /s$|^now$/.test(text) && y > 0.8);
    assert.ok(axis.some(({ text, x }) => first.test(text) && x < 0.3), JSON.stringify(axis.slice(0, 12)));
    assert.ok(axis.some(({ text, x }) => last.test(text) && x > 0.7), JSON.stringify(axis.slice(0, 12)));
    await page.close();
  }
  await replay.stop();
});

test('settings: two pages agree, both methods side by side, refusals are reported', async () => {
  const page = await openPage(browser, server.url);
  const other = await openPage(browser, server.url);
  await page.locator('#mode').selectOption('both');
  await other.waitForFunction(() => document.body.dataset.mode === 'both');
  const restart = async (id, value) => {
    await page.locator(`#${id}`).selectOption(value);
    await page.locator('#ask-restart').click();
  };
  const time_s = () => number(other, 't_s');
  const asked_s = await time_s();
  await page.locator('#rate_hz').selectOption('500');
  assert.match(await page.locator('#ask-text').textContent(), /^Rate 500 Hz: .* recorded ticks are lost\.$/);
  await page.locator('#ask-cancel').click();
  await page.waitForTimeout(500);
  assert.equal(await other.locator('#rate_hz').inputValue(), '1000');
  assert.ok(await time_s() > asked_s, 'it restarted without being told to');
  await restart('rate_hz', '500');
  await other.waitForFunction(() => document.getElementById('rate_hz').value === '500');
  await page.locator('#stiffness_N_m').evaluate((slider) => {
    slider.value = '3000';
    slider.dispatchEvent(new Event('change'));
  });
  await page.locator('#note').waitFor();
  assert.match(await page.locator('#note').textContent(), /stability limit/);
  assert.equal(await other.locator('#stiffness_N_m').inputValue(), '500');
  await page.locator('#mode').selectOption('surface');
  await restart('rate_hz', '1000');
  await other.waitForFunction(() => document.getElementById('rate_hz').value === '1000');
  for (const device of ['falcon', 'pantograph', 'hapkit', 'cartesian', 'premium']) {
    await restart('device', device);
    await other.waitForFunction((name) => document.getElementById('device').value === name, device);
  }
  assert.deepEqual([...page.troubles, ...other.troubles], []);
  await page.close();
  await other.close();
});

test('octants, picture and trace', async () => {
  const page = await openPage(browser, server.url);
  const before = await page.locator('#view').screenshot();
  await page.locator('#show-octants').check();
  await page.waitForTimeout(1500);
  assert.notDeepEqual(await page.locator('#view').screenshot(), before);
  const [picture] = await Promise.all([page.waitForEvent('download'), page.locator('#save-picture').click()]);
  const png = readFileSync(await picture.path());
  assert.equal(png.toString('latin1', 1, 4), 'PNG');
  assert.ok(pixels(png).colours > 100);
  const [trace] = await Promise.all([page.waitForEvent('download'), page.locator('#save-trace').click()]);
  const rows = readFileSync(await trace.path(), 'utf8').trim().split('\n');
  assert.match(rows[0], /^t_s,probe_x_m/);
  assert.ok(rows.length > 500, `${rows.length} rows`);
  await page.close();
});

test('on every screen the open controls cover neither the hint nor the buttons', async () => {
  for (const [width, height] of [[360, 740], [820, 1180], [1280, 720]]) {
    const page = await openPage(browser, server.url, { viewport: { width, height }, hasTouch: true, colorScheme: 'dark' });
    if (width <= 900) {
      assert.ok(!(await page.locator('#panel').isVisible()));
      await page.locator('#panel-toggle').tap();
    }
    assert.ok(await page.locator('#panel').isVisible());
    await page.locator('#faults summary').click();
    await page.getByRole('button', { name: 'estop:pressed' }).click();
    await state(page, 'fault');
    for (const id of ['arm', 'stop', 'clear', 'hint']) {
      const free = await page.locator(`#${id}`).evaluate((element) => {
        const box = element.getBoundingClientRect();
        // The top right place of the text of the hint, the middle of a button.
        const at = (x, y) => element.contains(document.elementFromPoint(box.left + x * box.width, box.top + y * box.height));
        const isInside = box.left >= 0 && box.right <= innerWidth && box.bottom <= innerHeight && box.height > 10;
        return isInside && at(0.5, 0.5) && at(0.05, 0.2) && at(0.95, 0.2);
      });
      assert.ok(free, `#${id} on ${width} x ${height}`);
    }
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${wide} of ${width} pixels wide`);
    const picture = await page.locator('#view').boundingBox();
    assert.ok(picture.height > 150, `a picture of ${picture.height} pixels`);
    await page.locator('#clear-injections').click();
    await page.locator('#clear').click();
    await state(page, 'idle');
    await page.close();
  }
});

test('reconnects after a restart of the server', async () => {
  const own = await startServer([blob]);
  const page = await openPage(browser, own.url);
  await own.stop();
  await page.locator('#offline').waitFor();
  const again = await startServer([blob], own.port);
  await page.locator('#offline').waitFor({ state: 'hidden' });
  await state(page, 'active');
  await page.reload();
  await shown(page);
  await state(page, 'active');
  await page.close();
  await again.stop();
});

test('a trace: the values of a tick are those of its row', async () => {
  const csv = join(folder, 'rub.csv');
  execFileSync(tactree, ['simulate', blob, '--seconds', '1', '--script', 'rub', '--trace', csv], { stdio: 'pipe' });
  const [heading, ...rows] = readFileSync(csv, 'utf8').trim().split('\n').map((row) => row.split(','));
  const replay = await startServer([blob, '--trace', csv]);
  const page = await openPage(browser, replay.url);
  const names = ['t_s', 'probe_x_m', 'probe_y_m', 'probe_z_m', 'proxy_x_m', 'proxy_y_m', 'proxy_z_m', 'force_x_N',
    'force_y_N', 'force_z_N', 'normal_x', 'velocity_x_m_s', 'tip_z_m', 'penetration_m', 'strength'];
  const check = async (tick) => {
    await until(page, ['tick'], (shownTick) => shownTick === tick, 'the tick');
    for (const name of names) {
      const wanted = Number(rows[tick][heading.indexOf(name)]);
      assert.equal(await number(page, name), Number(wanted.toPrecision(9)), `${name} of tick ${tick}`);
    }
  };
  for (const tick of [0, 333, 700, rows.length - 1]) {
    await page.locator('#scrub').fill(String(tick));
    await check(tick);
  }
  await page.locator('#step-back').click();
  await check(rows.length - 2);
  await page.locator('#scrub').fill('500');
  await page.locator('#view').focus();
  await check(500);
  await page.keyboard.press('ArrowRight');
  await check(501);
  assert.ok(!(await page.locator('#arm').isVisible()), 'a trace cannot be armed');
  assert.deepEqual(page.troubles, []);
  await page.close();
  await replay.stop();
});
