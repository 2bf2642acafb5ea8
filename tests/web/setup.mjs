// Shared by the tests: models, the program under test, the browser.
import { execFileSync, spawn } from 'node:child_process';
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { mkdtempSync, rmSync } from 'node:fs';
import { chromium } from 'playwright-core';

export const tactree = process.env.TACTREE;
export const folder = mkdtempSync(join(tmpdir(), 'tactree-web-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

/** Points of a sphere with bumps, spread evenly, with normals: `count` rows x y z nx ny nz. */
export function bumpySphere(count, radius = 0.04, height = 0.002) {
  const rows = [];
  const turn = Math.PI * (3 - Math.sqrt(5));
  const shape = (u, v) => radius + height * Math.sin(6 * u) * Math.sin(5 * v);
  const at = (u, v) => {
    const r = shape(u, v);
    return [r * Math.cos(u) * Math.sin(v), r * Math.sin(u) * Math.sin(v), r * Math.cos(v)];
  };
  for (let i = 0; i < count; ++i) {
    const v = Math.acos(1 - (2 * (i + 0.5)) / count);
    const u = (i * turn) % (2 * Math.PI);
    rows.push([...at(u, v), ...normalAt(at, u, v)].map((x) => x.toPrecision(7)).join(' '));
  }
  return rows.join('\n') + '\n';
}

function normalAt(at, u, v) {
  const step = 1e-4;
  const diff = (a, b) => a.map((x, i) => x - b[i]);
  const along = diff(at(u + step, v), at(u - step, v));
  const down = diff(at(u, v + step), at(u, v - step));
  const n = [
    down[1] * along[2] - down[2] * along[1],
    down[2] * along[0] - down[0] * along[2],
    down[0] * along[1] - down[1] * along[0],
  ];
  const size = Math.hypot(...n);
  return n.map((x) => x / size);
}

export function buildModel(name, points, options = []) {
  mkdirSync(folder, { recursive: true });
  const blob = join(folder, `${name}.blob`);
  if (!existsSync(blob)) {
    writeFileSync(join(folder, `${name}.xyz`), points);
    execFileSync(tactree, ['build', join(folder, `${name}.xyz`), '-o', blob, ...options], { stdio: 'pipe' });
  }
  return blob;
}

/** `tactree` with these arguments, once it says what `pattern` finds: { said, stop() }. */
function startProgram(args, pattern) {
  const child = spawn(tactree, args);
  let text = '';
  child.stderr.on('data', (data) => process.stderr.write(data));
  return new Promise((done, failed) => {
    child.on('exit', (code) => failed(new Error(`tactree ${args[0]} ended with ${code}`)));
    child.stdout.on('data', (data) => {
      text += data;
      const said = pattern.exec(text)?.[1];
      if (!said) return;
      const stop = () => new Promise((ended) => {
        if (child.exitCode !== null) return ended();
        child.removeAllListeners('exit');
        child.on('exit', ended);
        child.kill('SIGTERM');
      });
      done({ said, stop });
    });
  });
}

/** `tactree view` with these arguments: { url, port, stop() }, once it listens. */
export async function startServer(args, port = 0) {
  const { said, stop } = await startProgram(['view', '--page-port', String(port), ...args], /(http:\/\/[^ ]*\/)/);
  return { url: said, port: Number(new URL(said).port), stop };
}

/** A simulated board that programs talk to: { port, stop() }, once it listens. */
export async function startBoard(args) {
  const { said, stop } = await startProgram(['simulate', '--serve', ...args], /serving at (\S+)\n/);
  return { port: said, stop };
}

export const launch = () => chromium.launch({
  executablePath: process.env.CHROMIUM,
  // As on a computer without a GPU: the processor draws page and picture. As root a browser has no sandbox.
  args: ['--no-sandbox', '--disable-gpu', '--enable-unsafe-swiftshader'],
});

/** A page that shows the model, and whatever went wrong on it. */
export async function openPage(browser, url, options = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, ...options });
  page.troubles = [];
  page.foreign = [];
  page.on('pageerror', (error) => page.troubles.push(error.message));
  page.on('console', (message) => message.type() === 'error' && page.troubles.push(message.text()));
  page.on('request', (request) => {
    const here = request.url().startsWith(url) || /^(blob|data|ws):/.test(request.url());
    if (!here) page.foreign.push(request.url());
  });
  await page.goto(url, { timeout: 120000 });
  await shown(page);
  return page;
}

export const shown = (page) =>
  page.waitForFunction(() => document.documentElement.dataset.firstPicture, null, { timeout: 60000 });

/** Waits until the controller is in this state. */
export async function state(page, name, timeout = 60000) {
  try {
    await page.waitForFunction((wanted) => document.getElementById('state').textContent === wanted, name,
      { timeout });
  } catch (error) {
    const said = [];
    for (const id of ['state', 'fault-names', 'note']) said.push(await page.locator(`#${id}`).textContent());
    throw new Error(`not ${name}: ${said.join(', ')}`, { cause: error });
  }
}

/** Figures of the table of numbers, all of one tick. */
async function numbers(page, names) {
  const box = page.locator('#numbers-box');
  if (!(await box.evaluate((one) => one.open))) {
    await box.evaluate((one) => { one.open = true; });
    await page.waitForTimeout(200); // what it shows is of when it was closed
  }
  await page.locator(`#numbers td[data-name='${names[0]}']`).waitFor({ state: 'attached' });
  return page.evaluate((wanted) => wanted.map((name) =>
    Number(document.querySelector(`#numbers td[data-name='${name}']`)?.textContent)), names);
}

/** A figure of the table of numbers. */
export const number = async (page, name) => (await numbers(page, [name]))[0];

/** Waits until `test` of the numbers with these names is true; the numbers then. */
export async function until(page, names, test, what, timeout = 60000) {
  const end = Date.now() + timeout;
  for (;;) {
    const values = await numbers(page, names);
    if (test(...values)) return values;
    if (Date.now() > end) throw new Error(`${what}: ${names.join(', ')} = ${values.join(', ')}`);
    await page.waitForTimeout(50);
  }
}
