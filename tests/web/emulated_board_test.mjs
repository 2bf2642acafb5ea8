// The page of `tactree view --port` with a board in the emulator, which counts instructions.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { plugIn, small, watch } from './board_rig.mjs';
import { launch, openPage, state } from './setup.mjs';

let browser;
before(async () => {
  browser = await launch();
});
after(async () => {
  await browser?.close();
});

test('shows the instructions of an emulated board, below the bound', async (t) => {
  await plugIn(t, '--board', 'mps2-an386');
  const server = await watch(t);
  const page = await openPage(browser, server.url, small);
  await state(page, 'idle');
  assert.equal(await page.locator('#work-name').textContent(), 'Instructions');
  const [taken, bound] = await page.waitForFunction(() => {
    const found = /^([\d,]+) of ([\d,]+)$/.exec(document.getElementById('work-now').value);
    return found && found.slice(1).map((digits) => Number(digits.replaceAll(',', '')));
  }).then((handle) => handle.jsonValue());
  assert.ok(taken > 500 && bound > 10000 && taken < bound, `${taken} of ${bound}`);
  assert.equal(await page.locator('#work-why').textContent(), '');
  // The line of the bound, in its colour.
  const lines = () => page.locator('#strip-work').evaluate((canvas) => {
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let red = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 128 && data[i] > data[i + 1] + 80) ++red;
    return red / canvas.width;
  });
  assert.ok(await lines() > 0.5, 'the bound is not drawn');
  await page.close();
});
