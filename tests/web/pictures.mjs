// Makes the pictures of the page for the documentation; called by scripts/pages/pictures.py.
// usage: TACTREE=... CHROMIUM=... node pictures.mjs BLOB FOLDER
import { join } from 'node:path';
import { launch, number, openPage, startServer, state } from './setup.mjs';

// Camera position, and the depth to which the hand presses without slipping off.
const TURNS = 14;
const DEPTH_M = 0.0009;

const [, , blob, into] = process.argv;

/** Moves the hand into the object with the keys, until it presses. */
async function press(page, wanted_m) {
  await page.locator('#view').focus();
  for (let i = 0; i < 150 && (await number(page, 'penetration_m')) < wanted_m; ++i) {
    await page.keyboard.press('ArrowDown');
    await page.waitForTimeout(40);
  }
}

async function take(page, name) {
  await page.locator('#numbers-box').evaluate((box) => { box.open = false; });
  await page.locator('#stage').hover(); // no focus ring in the picture
  await page.evaluate(() => document.activeElement?.blur());
  await page.waitForTimeout(2500); // all points that there are
  await page.screenshot({ path: join(into, name) });
  console.log(join(into, name));
}

const browser = await launch();
const server = await startServer([blob, '--stiffness', '800']);
const page = await openPage(browser, server.url, { colorScheme: 'light' });
await state(page, 'active');
await page.locator('#view').focus();
for (let i = 0; i < TURNS; ++i) await page.keyboard.press('Shift+ArrowRight');
for (let i = 0; i < 3; ++i) await page.keyboard.press('+');
await press(page, DEPTH_M);
await take(page, 'page.png');

await page.emulateMedia({ colorScheme: 'dark' });
await page.locator('#mode').selectOption('both');
await page.locator('#view').focus();
await page.waitForTimeout(1500);
await state(page, 'active');
await press(page, DEPTH_M);
for (let i = 0; i < 8; ++i) {
  await page.keyboard.press(i < 4 ? 'ArrowLeft' : 'ArrowRight');
  await page.waitForTimeout(150);
}
await take(page, 'page-both.png');
await browser.close();
await server.stop();
