// The page of `tactree view --port` with a simulated board: display, commands, stop.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { blob, cable, plugIn, RADIUS, small, watch } from './board_rig.mjs';
import { buildModel, bumpySphere, folder, launch, openPage, state, tactree, until } from './setup.mjs';

const other = buildModel('smaller', bumpySphere(6000, 0.02, 0), ['--unit', 'm']);
const FORCE = ['force_x_N', 'force_y_N', 'force_z_N'];
let browser;

before(async () => {
  browser = await launch();
});
after(async () => {
  await browser?.close();
});

/** Hides the picture: software rendering delays the link of the board. */
const hidePicture = (page) => page.locator('#view').evaluate((canvas) => { canvas.style.display = 'none'; });

/** Repeats `act` if a busy computer made the board report link-lost. */
async function whileLinked(page, act) {
  for (let left = 5; ; --left) {
    try {
      return await act();
    } catch (error) {
      if (left === 0 || !/link-lost/.test(await page.locator('#fault-names').textContent())) throw error;
      await page.locator('#clear').click();
      await state(page, 'idle');
    }
  }
}

async function arm(page) {
  // A board does not arm inside the object.
  await until(page, ['probe_x_m', 'probe_y_m', 'probe_z_m'], (...at) => Math.hypot(...at) > RADIUS + 0.001,
    'the hand does not come back');
  await page.locator('#arm').click();
  await state(page, 'active');
}

test('shows the force of the board; a stop from any page ends it', async (t) => {
  await plugIn(t);
  const server = await watch(t);
  const page = await openPage(browser, server.url, small);
  await hidePicture(page);
  const second = await browser.newPage();
  await second.goto(`${server.url}faults/`);
  await state(page, 'idle');
  assert.match(await page.locator('#board-name').textContent(), /^host, firmware \d/);
  const otherPage = () => second.evaluate(() => {
    const socket = new WebSocket(`ws://${location.host}/live`);
    socket.onopen = () => socket.send('{"do": "stop"}');
  });
  for (const stop of [() => page.keyboard.press('Space'), otherPage]) {
    await whileLinked(page, async () => {
      await arm(page);
      const [depth, ...rest] = await until(page, ['penetration_m', 'proxy_x_m', 'proxy_y_m', 'proxy_z_m', ...FORCE],
        (deep, x, y, z, ...force) => deep > 0 && Math.hypot(...force) > 0.2, 'no force');
      assert.ok(depth < 0.01, `${depth} m deep`);
      assert.ok(Math.abs(Math.hypot(...rest.slice(0, 3)) - RADIUS) < 5e-4, `the proxy is at ${rest.slice(0, 3)}`);
      await stop();
      await state(page, 'idle');
      await until(page, FORCE, (...f) => Math.hypot(...f) === 0, 'still force');
    });
  }
  assert.deepEqual(page.troubles, []);
  await page.close();
  await second.close();
});

test('homes a board, which then arms', async (t) => {
  await plugIn(t, '--unhomed');
  const server = await watch(t);
  const page = await openPage(browser, server.url, small);
  await state(page, 'idle');
  await page.locator('#home').waitFor();
  assert.equal(await page.locator('#why').textContent(),
    'not homed: hold the device in its home pose and press Home');
  await page.locator('#arm').click();
  await page.locator('#note', { hasText: 'home it first' }).waitFor();
  assert.equal(await page.locator('#state').textContent(), 'idle');
  await page.locator('#home').click();
  await page.locator('#home').waitFor({ state: 'hidden' });
  assert.equal(await page.locator('#why').textContent(), 'stopped: press Arm');
  await hidePicture(page);
  await whileLinked(page, () => arm(page));
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('says that a board is operated by its button; may watch and stop it', async (t) => {
  await plugIn(t, '--panel', '--press', '0.2..1.4', '--press', '20..21.2');
  const server = await watch(t);
  const page = await openPage(browser, server.url);
  await hidePicture(page);
  await page.getByText('The board is operated by its button.').waitFor();
  for (const control of ['#arm', '#clear', '#stiffness_N_m', '#force_max_N']) {
    assert.ok(await page.locator(control).isDisabled(), control);
  }
  assert.ok(await page.locator('#home').isHidden());
  await state(page, 'idle');
  assert.match(await page.locator('#why').textContent(), /hold the button of the board for 1 s$/);
  await state(page, 'active');
  await page.locator('#stop').click();
  await state(page, 'idle');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('disables what a board does not support, with the reason; applies the other settings', async (t) => {
  await plugIn(t);
  const server = await watch(t);
  const page = await openPage(browser, server.url);
  await state(page, 'idle');
  for (const control of ['#mode', '#device']) assert.ok(await page.locator(control).isHidden(), control);
  assert.ok(await page.locator('#rate_hz').isDisabled());
  assert.ok(await page.getByText('Fixed by the configuration of the board.').isVisible());
  await page.locator('#faults summary').click();
  assert.ok(await page.locator('#clear-injections').isDisabled());
  assert.ok(await page.getByText('Simulation only: run tactree view without --port.').isVisible());
  assert.ok(await page.getByText("The hand is at the board's device").isVisible());
  assert.match(await page.locator('#work-why').textContent(), /counts neither instructions nor cycles/);
  const set = (id, value) => page.locator(id).evaluate((slider, wanted) => {
    slider.value = wanted;
    slider.dispatchEvent(new Event('change'));
  }, value);
  await set('#stiffness_N_m', '300');
  await set('#force_max_N', '2');
  await page.waitForFunction(() => document.querySelector("output[for='force_max_N']").value === '2 N'
    && document.querySelector("output[for='stiffness_N_m']").value === '300 N/m');
  await set('#texture_height_m', '0.2');
  await page.waitForFunction(() => document.querySelector("output[for='texture_height_m']").value === '0.2 mm');
  assert.ok(await page.locator('#note').isHidden());
  await set('#damping_Ns_m', '0');
  await set('#stiffness_N_m', '3000'); // not without damping
  await page.locator('#note').waitFor();
  assert.match(await page.locator('#note').textContent(), /stiff/);
  await page.waitForFunction(() => document.querySelector("output[for='stiffness_N_m']").value === '300 N/m');
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('reports an unplugged board; reconnects without arming when it is back', async (t) => {
  let board = await plugIn(t);
  const server = await watch(t);
  const page = await openPage(browser, server.url, small);
  await state(page, 'idle');
  await hidePicture(page);
  await whileLinked(page, () => arm(page));
  await board.stop();
  await page.locator('#board-gone').waitFor();
  assert.match(await page.locator('#board-why').textContent(), /^The board is (disconnected|not reachable)/);
  await state(page, 'no board');
  assert.equal(await page.locator('#force-now').textContent(), '–');
  assert.ok(await page.locator('#arm').isDisabled());
  board = await plugIn(t);
  await page.locator('#board-gone').waitFor({ state: 'hidden' });
  await state(page, 'idle');
  await page.waitForTimeout(1000);
  assert.equal(await page.locator('#state').textContent(), 'idle');
  await whileLinked(page, () => arm(page));
  await page.close();
});

test('reports a fault of the board with a link to its page, and that its cause persists', async (t) => {
  await plugIn(t, '--inject', 'estop:pressed@0');
  const server = await watch(t);
  const page = await openPage(browser, server.url, small);
  await state(page, 'fault');
  assert.match(await page.locator('#fault-names').textContent(), /emergency-stop/);
  assert.equal(await page.locator('#fault-page').getAttribute('href'), '/faults/emergency-stop');
  await page.locator('#clear').click();
  await page.locator('#note', { hasText: 'Not cleared: the cause of emergency-stop persists' }).waitFor();
  await page.close();
});

/** The rows of a recording: { column: cell }. */
function recorded(name) {
  const [heading, ...rows] = readFileSync(join(folder, name), 'utf8').trimEnd().split('\n');
  const columns = heading.split(',');
  return rows.map((row) => Object.fromEntries(row.split(',').map((cell, i) => [columns[i], cell])));
}

test('records into a file, without arming; the file of a lost board is complete', async (t) => {
  const board = await plugIn(t);
  const server = await watch(t, '--recording', join(folder, 'page.csv'));
  const page = await openPage(browser, server.url);
  await hidePicture(page);
  await state(page, 'idle');
  const button = page.locator('#record');
  const shown = page.locator('#recording');
  await button.click();
  await page.locator('#record', { hasText: 'End recording' }).waitFor();
  await page.waitForFunction(() => / [0-9]{4,} ticks in /.test(document.getElementById('recording').textContent));
  await button.click();
  await page.locator('#record', { hasText: /^Record$/ }).waitFor();
  await page.waitForFunction(() => !document.getElementById('record').disabled);
  // What the page states is in the file.
  const text = await shown.textContent();
  const rows = recorded('page.csv');
  assert.ok(text.startsWith(join(folder, 'page.csv')), text);
  assert.ok(text.includes(`: ${rows.length} ticks in `), text);
  const missing = rows.reduce((sum, row) => sum + Number(row.missing_ticks), 0);
  assert.match(text, missing === 0 ? /none missing/ : new RegExp(`, ${missing} missing in`));
  assert.equal(Number(rows.at(-1).tick) - Number(rows[0].tick) + 1, rows.length + missing);
  assert.deepEqual([...new Set(rows.map((row) => row.state))], ['idle']);

  await button.click(); // another file
  await page.locator('#recording', { hasText: /page-2.csv: [0-9]{3,} ticks/ }).waitFor();
  await board.stop();
  await page.locator('#note', { hasText: 'the recording ended early. The board is' }).waitFor();
  await page.locator('#board-gone').waitFor();
  assert.ok(await button.isDisabled());
  assert.ok(recorded('page-2.csv').length > 99);
  assert.deepEqual(page.troubles, []);
  await page.close();
});

test('warns if the board uses a model other than the displayed one', async (t) => {
  await plugIn(t);
  for (const [model, warned] of [[other, true], [blob, false]]) {
    execFileSync(tactree, ['flash', model, '--port', cable], { stdio: 'pipe' });
    const server = await watch(t);
    const page = await openPage(browser, server.url, small);
    await state(page, 'idle');
    assert.equal(await page.locator('#model-warning').isVisible(), warned);
    assert.match(await page.locator('#board-model').textContent(), warned ? /a model other than/ : /the displayed model/);
    assert.deepEqual(page.troubles, []);
    await page.close();
    await server.stop();
  }
});
