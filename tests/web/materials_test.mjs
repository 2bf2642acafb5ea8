// The materials of a model on the page: an overlay with a legend, and rules from the colours of the scan.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { buildModel, bumpySphere, folder, launch, openPage, startServer, state, tactree } from './setup.mjs';

const RADIUS = 0.03;
let browser;
let blob;
let rules;
let scan;
let report;

/** A ball, PLY, whose side of +x is red. */
function colouredBall(count) {
  const head = ['ply', 'format ascii 1.0', `element vertex ${count}`];
  for (const name of ['x', 'y', 'z', 'nx', 'ny', 'nz']) head.push(`property float ${name}`);
  for (const name of ['red', 'green', 'blue']) head.push(`property uchar ${name}`);
  const rows = [...head, 'end_header'];
  for (let i = 0; i < count; ++i) {
    const z = 1 - (2 * i + 1) / count;
    const turn = i * Math.PI * (3 - Math.sqrt(5));
    const n = [Math.sqrt(1 - z * z) * Math.cos(turn), Math.sqrt(1 - z * z) * Math.sin(turn), z];
    const numbers = [...n.map((v) => RADIUS * v), ...n].map((v) => v.toFixed(7));
    rows.push(`${numbers.join(' ')} ${n[0] > 0 ? '250 10 5' : '120 120 120'}`);
  }
  return `${rows.join('\n')}\n`;
}

before(async () => {
  browser = await launch();
  scan = join(folder, 'red.ply');
  report = join(folder, 'red.json');
  rules = join(folder, 'rules.json');
  blob = join(folder, 'red.blob');
  writeFileSync(scan, colouredBall(20000));
  writeFileSync(rules, JSON.stringify({
    default: { stiffness_N_m: 800, static_friction: 0.3, dynamic_friction: 0.2 },
    colours: [{ name: 'felt', rgb: [255, 0, 0], tolerance: 30, stiffness_N_m: 200 }],
  }));
  execFileSync(tactree, ['build', scan, '-o', blob, '--unit', 'm', '--material', rules, '--report', report],
    { stdio: 'pipe' });
});
after(async () => {
  await browser?.close();
});

async function openSession(t, args) {
  const server = await startServer(args);
  t.after(server.stop);
  const page = await openPage(browser, server.url);
  t.after(() => page.close());
  await state(page, 'active');
  return page;
}

/** Colour of the picture in its middle, which shows the side of +x. */
async function middle(page) {
  const png = (await page.locator('#view').screenshot()).toString('base64');
  return page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const picture = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const context = new OffscreenCanvas(picture.width, picture.height).getContext('2d');
    context.drawImage(picture, 0, 0);
    // Below the middle, where neither hand nor probe is.
    return [...context.getImageData(picture.width / 2, 0.65 * picture.height, 1, 1).data].slice(0, 3);
  }, png);
}

test('materials are shown with a legend that names them', async (t) => {
  const page = await openSession(t, [blob, '--material', rules]);
  assert.ok(await page.locator('#material-list').isHidden());
  const before_rgb = await middle(page);
  await page.locator('#show-materials').check();
  const rows = await page.locator('#material-list li').allTextContents();
  assert.equal(rows.length, 2);
  assert.match(rows[0], /^default: 800 N\/m, friction 0\.3 \/ 0\.2 · [\d,]+ points$/);
  assert.match(rows[1], /^felt: 200 N\/m, friction/);
  assert.equal(await page.locator('#material-list li').nth(1).locator('i').count(), 2);
  await page.waitForTimeout(2000); // the materials of all nodes
  const shown_rgb = await middle(page);
  const change = Math.max(...shown_rgb.map((v, i) => Math.abs(v - before_rgb[i])));
  assert.ok(change > 25, `${before_rgb} became ${shown_rgb}`);
  await page.locator('#show-materials').uncheck();
  await page.waitForTimeout(1000);
  const after_rgb = await middle(page);
  assert.ok(Math.max(...after_rgb.map((v, i) => Math.abs(v - before_rgb[i]))) < 12);
  assert.deepEqual(page.troubles, []);
});

test('the page says when the materials of the model overrule its sliders', async (t) => {
  const page = await openSession(t, [blob]);
  const note = page.locator('#materials-note');
  await note.waitFor();
  await page.locator('#use_materials').uncheck();
  await note.waitFor({ state: 'hidden' });
  const plain = await openSession(t, [buildModel('plain', bumpySphere(6000, RADIUS, 0), ['--unit', 'm'])]);
  assert.ok(await plain.locator('#materials-note').isHidden());
});

test('without the file of the build materials have numbers, and other files are refused', async (t) => {
  const page = await openSession(t, [blob]);
  await page.locator('#show-materials').check();
  assert.match((await page.locator('#material-list li').allTextContents())[1], /^material 1: 200 N\/m/);
  const other = join(folder, 'other.json');
  writeFileSync(other, JSON.stringify({ default: { stiffness_N_m: 700 } }));
  assert.throws(() => execFileSync(tactree, ['view', blob, '--page-port', '0', '--material', other],
    { stdio: 'pipe', timeout: 60000 }), /describes 1 materials/);
});

test('a click on a colour of the scan makes a material of the sliders', async (t) => {
  const page = await openSession(t, [blob, '--report', report]);
  const { colours } = JSON.parse(readFileSync(report, 'utf8'));
  assert.equal(colours.length, 2);
  await page.locator('#rules summary').click();
  const buttons = page.locator('#rule-list li button:first-child');
  assert.equal(await buttons.count(), 2);
  assert.ok(await page.locator('#rules-save').isDisabled());
  await page.locator('#stiffness_N_m').evaluate((slider) => {
    slider.value = '300';
    slider.dispatchEvent(new Event('input'));
    slider.dispatchEvent(new Event('change'));
  });
  await page.locator('#texture_height_m').evaluate((slider) => {
    slider.value = '0.2';
    slider.dispatchEvent(new Event('input'));
    slider.dispatchEvent(new Event('change'));
  });
  await buttons.nth(1).click();
  assert.match(await buttons.nth(1).textContent(), /^300 N\/m, friction .*, texture 0\.2 mm$/);
  await buttons.nth(0).click();
  await page.locator('#rule-list .quiet').first().click(); // takes it back
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#rules-save').click()]);
  const file = join(folder, 'materials.json');
  await download.saveAs(file);
  const made = JSON.parse(readFileSync(file, 'utf8'));
  assert.equal(made.colours.length, 1);
  assert.deepEqual(made.colours[0].rgb, colours[1].rgb);
  assert.equal(made.colours[0].stiffness_N_m, 300);
  assert.equal(made.colours[0].texture_height_m, 0.0002);
  assert.equal(made.colours[0].texture_wavelength_m, 0.002);
  const again = join(folder, 'again.blob');
  execFileSync(tactree, ['build', scan, '-o', again, '--unit', 'm', '--material', file], { stdio: 'pipe' });
  const facts = join(folder, 'again.json');
  execFileSync(tactree, ['info', again, '--material', file, '--json', facts], { stdio: 'pipe' });
  assert.equal(JSON.parse(readFileSync(facts, 'utf8')).material_list.length, 2);
  assert.deepEqual(page.troubles, []);
});

test('a model is shown in the colours of its scan', async (t) => {
  const plain = join(folder, 'plain.blob');
  const colours = join(folder, 'plain.colours');
  execFileSync(tactree, ['build', scan, '-o', plain, '--unit', 'm', '--colours', colours], { stdio: 'pipe' });
  const page = await openSession(t, [plain, '--colours', colours]);
  assert.ok(await page.locator('#show-colours').isChecked());
  await page.waitForTimeout(2000); // the colours of all nodes
  const [red, green] = await middle(page);
  assert.ok(red > 2 * green, `${red}, ${green}`);
  await page.locator('#show-colours').uncheck();
  await page.waitForTimeout(1000);
  const [plain_red, plain_green] = await middle(page);
  assert.ok(plain_red < 1.5 * plain_green, `${plain_red}, ${plain_green}`);
  assert.deepEqual(page.troubles, []);
  assert.throws(() => execFileSync(tactree, ['view', blob, '--page-port', '0', '--colours', colours],
    { stdio: 'pipe', timeout: 60000 }), /belongs to another blob/);
});

test('a report without colours, and another file, are refused', () => {
  const empty = join(folder, 'empty.json');
  for (const [content, why] of [['{"colours": []}', /the scan of this report has no colours/],
    ['{}', /is not the report of a build/], ['text', /is not the report of a build/]]) {
    writeFileSync(empty, content);
    assert.throws(() => execFileSync(tactree, ['view', blob, '--page-port', '0', '--report', empty],
      { stdio: 'pipe', timeout: 60000 }), why);
  }
});
