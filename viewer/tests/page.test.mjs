// SPDX-License-Identifier: Apache-2.0
// The page in headless Chromium, drawn in software: it opens materials, and light and view
// change what it shows.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { pathToFileURL } from 'node:url';

import { closeWatched, launch, PATIENCE, pixelsOf, serve, watchedPage } from './browser.mjs';
import { measuredMaterial, photographMaterial, ROOT, sateen, scratch } from './support.mjs';

const folder = scratch(after);
let browser;
let server;
let watched;
let page;

before(async () => {
  const files = {
    '/': join(ROOT, 'viewer/dist/viewer.html'),
    '/photo.sateen': photographMaterial(folder),
    '/measured.sateen': measuredMaterial(folder),
  };
  server = await serve((path) => files[path]);
  browser = await launch();
}, { timeout: PATIENCE });

after(async () => {
  await browser?.close();
  server?.close();
});

const DESKTOP = { viewport: { width: 780, height: 240 } };

async function newPage(options = DESKTOP) {
  watched = await watchedPage(browser, options);
  ({ page } = watched);
}

beforeEach(() => newPage());
afterEach(() => closeWatched(watched, server.origin));

async function open(query = '', ready = true) {
  await page.goto(`${server.origin}/${query}`);
  await page.waitForFunction(() => document.body.dataset.started === 'true');
  if (ready) assert.equal(await page.evaluate(() => document.body.dataset.ready), 'true');
}

/** Pixels of the picture, 96 × 96 from its middle, after it has been drawn. */
const pixels = async () => (await pixelsOf(page, 96)).data;

const mean = (values) => values.reduce((s, x) => s + x, 0) / values.length;
const colours = (data) => data.filter((_, i) => i % 4 !== 3);
const difference = (a, b) => mean(a.map((x, i) => Math.abs(x - b[i])));
const deviation = (data) => {
  const grey = colours(data).filter((_, i) => i % 3 === 1);
  const m = mean(grey);
  return Math.sqrt(mean(grey.map((x) => (x - m) ** 2)));
};

test('opens a material by address, and light and view change the picture', { timeout: PATIENCE }, async () => {
  await open('?url=measured.sateen');
  assert.ok((await page.textContent('#name')).length > 0);
  assert.match(await page.textContent('#facts'), /KB · 5 views × 5 lights/);
  const first = await pixels();
  assert.ok(deviation(first) > 4, `a picture without texture: ${deviation(first)}`);
  assert.ok(difference(first, await pixels()) === 0, 'a picture that changes by itself');

  await page.click('#pad', { position: { x: 75, y: 60 } });
  const relit = await pixels();
  assert.ok(difference(first, relit) > 2, 'the lamp has no effect');
  await page.keyboard.press('ArrowUp');
  assert.ok(difference(relit, await pixels()) > 0.2, 'the lamp does not follow the keyboard');
  assert.match(await page.getAttribute('#pad', 'aria-valuetext'), /° from the viewer/);

  await page.focus('#canvas');
  await page.keyboard.press('ArrowLeft');
  const turned = await pixels();
  assert.ok(difference(relit, turned) > 1, 'the view has no effect');

  await page.mouse.move(230, 150);
  await page.mouse.down();
  await page.mouse.move(290, 160, { steps: 2 });
  await page.mouse.up();
  const dragged = await pixels();
  assert.ok(difference(turned, dragged) > 2, 'a drag does not turn it');
  await page.mouse.down({ button: 'right' });
  await page.mouse.move(150, 220, { steps: 2 });
  await page.mouse.up({ button: 'right' });
  assert.ok(difference(dragged, await pixels()) > 0.1, 'a right-drag does not move the lamp');
});

test('shapes, views, tint and scale change the picture, and it can be saved', { timeout: PATIENCE }, async () => {
  await open('?url=measured.sateen');
  let last = await pixels();
  const changes = async (what, act) => {
    await act();
    const now = await pixels();
    assert.ok(difference(last, now) > 0.5, `${what} has no effect`);
    last = now;
  };
  const set = (id, value) => page.$eval(`#${id}`, (input, v) => {
    input.value = v;
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
  await changes('plane', () => page.check('input[value="plane"]', { force: true }));
  await changes('index', () => page.check('input[value="index"]', { force: true }));
  await changes('combined', () => page.check('input[value="combined"]', { force: true }));
  await changes('tint', () => set('tint', '#ff4040'));
  await changes('scale', () => set('scale', '1'));
  await changes('exposure', () => set('exposure', '-1'));
  await changes('surroundings', () => page.selectOption('#surroundings', 'overcast'));
  const waiting = page.waitForEvent('download');
  await page.click('#save');
  const saved = await waiting;
  assert.match(saved.suggestedFilename(), /\.png$/);
  assert.equal(readFileSync(await saved.path()).subarray(1, 4).toString(), 'PNG');
});

const drop = (files) => page.evaluate((list) => {
  const transfer = new DataTransfer();
  for (const [name, base64] of list)
    transfer.items.add(new File([Uint8Array.from(atob(base64), (c) => c.charCodeAt(0))], name));
  dispatchEvent(new DragEvent('drop', { dataTransfer: transfer, bubbles: true, cancelable: true }));
}, files);

test('takes dropped files, compares two, and says what is wrong with a bad one', { timeout: PATIENCE }, async () => {
  await open('', false);
  assert.ok(await page.isVisible('#welcome'));
  const photo = readFileSync(join(folder, 'photo.sateen')).toString('base64');
  const measured = readFileSync(join(folder, 'measured.sateen')).toString('base64');

  await drop([['notes.sateen', Buffer.from('these are notes, of no material').toString('base64')]]);
  await page.waitForSelector('#message:not([hidden])');
  assert.match(await page.textContent('#message'), /notes\.sateen: not a Sateen material/);
  await drop([['cut.sateen', Buffer.from(photo, 'base64').subarray(0, 100).toString('base64')]]);
  await page.waitForFunction(() => document.getElementById('message').textContent.startsWith('cut.sateen'));
  assert.match(await page.textContent('#message'), /truncated or damaged/);

  await drop([['a.sateen', photo]]);
  await page.waitForFunction(() => document.body.dataset.ready === 'true');
  assert.ok(!(await page.isVisible('#welcome')) && !(await page.isVisible('#message')));
  const one = await pixels();
  assert.ok(deviation(one) > 4);

  await drop([['a.sateen', photo], ['b.sateen', measured]]);
  await page.waitForSelector('#divider:not([hidden])');
  const two = await pixels();
  assert.ok(difference(one, two) > 2, 'the second material is not shown');
  await page.focus('#divider');
  for (let i = 0; i < 3; ++i) await page.keyboard.press('ArrowRight');
  assert.equal(await page.getAttribute('#divider', 'aria-valuenow'), '56');
  assert.ok(difference(two, await pixels()) > 0.1, 'the divider has no effect');
});

test('works at the size of a phone, in the dark', { timeout: PATIENCE }, async () => {
  await watched.context.close();
  await newPage({ viewport: { width: 320, height: 560 }, hasTouch: true, isMobile: true, colorScheme: 'dark' });
  await open('?url=photo.sateen');
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  assert.ok(!(await page.isVisible('#panel')));
  await page.tap('#toggle');
  await page.waitForFunction(() => getComputedStyle(document.getElementById('panel')).visibility === 'visible');
  assert.equal(await page.getAttribute('#toggle', 'aria-expanded'), 'true');
  const { scroll, width } = await page.evaluate(() => ({ scroll: document.body.scrollWidth, width: innerWidth }));
  assert.ok(scroll <= width, `${scroll} wide on a screen of ${width}`);
  const before = await pixels();
  await page.tap('#pad', { position: { x: 70, y: 70 } });
  assert.ok(difference(before, await pixels()) > 1, 'the lamp has no effect');
});

test('the exported page opens from a disk', { timeout: PATIENCE }, async (t) => {
  if (!existsSync(join(process.env.SATEEN, '../../share/sateen/viewer.html'))) {
    t.skip('the program has no viewer');
    return;
  }
  const path = join(folder, 'whole.html');
  sateen('export', join(folder, 'measured.sateen'), '-o', path);
  assert.ok(readFileSync(path).length <= 1_000_000);
  await page.goto(pathToFileURL(path).href);
  await page.waitForFunction(() => document.body.dataset.ready === 'true');
  assert.ok(deviation(await pixels()) > 4);
});

test('every control can be named and reached', { timeout: PATIENCE }, async () => {
  await open('?url=measured.sateen');
  const unnamed = await page.evaluate(() =>
    [...document.querySelectorAll('button, input:not([hidden]), select, [tabindex="0"]')]
      .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length))
      .map((e) => e.outerHTML));
  assert.deepEqual(unnamed, []);
});
