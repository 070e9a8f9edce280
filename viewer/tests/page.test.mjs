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

test('a finger turns the object, two move the lamp', { timeout: PATIENCE }, async () => {
  await watched.context.close();
  await newPage({ viewport: { width: 320, height: 480 }, hasTouch: true, isMobile: true });
  await open('?url=photo.sateen');
  const touch = await watched.context.newCDPSession(page);
  /** Fingers from one place to another. */
  const drag = async (from, to) => {
    const points = (at) => at.map(([x, y], id) => ({ x, y, id }));
    await touch.send('Input.dispatchTouchEvent', { type: 'touchStart', touchPoints: points(from) });
    for (const share of [0.5, 1])
      await touch.send('Input.dispatchTouchEvent', {
        type: 'touchMove',
        touchPoints: points(from.map(([x, y], i) => [x + share * (to[i][0] - x), y + share * (to[i][1] - y)])),
      });
    await touch.send('Input.dispatchTouchEvent', { type: 'touchEnd', touchPoints: [] });
  };
  const lamp = () => page.getAttribute('#pad', 'aria-valuetext');
  const first = await pixels();
  const lampAt = await lamp();
  await drag([[120, 220]], [[190, 235]]);
  const turned = await pixels();
  assert.ok(difference(first, turned) > 1, 'a finger does not turn it');
  assert.equal(await lamp(), lampAt, 'a finger moves the lamp');
  await drag([[120, 200], [180, 200]], [[180, 240], [240, 240]]);
  assert.notEqual(await lamp(), lampAt, 'two fingers do not move the lamp');
});

test('everything can be reached and used without a mouse', { timeout: PATIENCE }, async () => {
  await open('?url=measured.sateen');
  const reached = new Set();
  for (let i = 0; i < 40; ++i) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => document.activeElement.id || document.activeElement.name));
  }
  for (const control of ['canvas', 'open', 'compare', 'save', 'mode', 'shape', 'mesh', 'pad', 'surroundings', 'scale',
    'relief', 'exposure', 'tint', 'reset', 'theme'])
    assert.ok(reached.has(control), `${control} cannot be reached: ${[...reached]}`);

  const first = await pixels();
  await page.focus('input[name="shape"]:checked');
  await page.keyboard.press('ArrowRight');
  const cloth = await pixels();
  assert.equal(await page.inputValue('input[name="shape"]:checked'), 'cloth');
  assert.ok(difference(first, cloth) > 1, 'the shape does not change');
  await page.focus('#exposure');
  for (let i = 0; i < 10; ++i) await page.keyboard.press('ArrowLeft');
  const darker = await pixels();
  assert.ok(mean(colours(cloth)) > mean(colours(darker)) + 1, 'the exposure does not change');
  await page.focus('#reset');
  await page.keyboard.press('Enter');
  assert.ok(difference(darker, await pixels()) > 0.5, 'nothing is reset');
});

/** A pyramid as an OBJ file, without normals and coordinates, and the same as a glTF with its data inside. */
const CORNERS = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1]];
const FACES = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]];
const pyramidObj = () => [...CORNERS.map((v) => `v ${v.join(' ')}`), ...FACES.map((f) => `f ${f.map((i) => i + 1).join(' ')}`)].join('\n');
function pyramidGltf() {
  const data = Buffer.concat([
    Buffer.from(new Float32Array(CORNERS.flat()).buffer), Buffer.from(new Uint16Array(FACES.flat()).buffer)]);
  return JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1 }] }],
    buffers: [{ byteLength: data.length, uri: `data:application/octet-stream;base64,${data.toString('base64')}` }],
    bufferViews: [{ buffer: 0, byteLength: 60 }, { buffer: 0, byteOffset: 60, byteLength: 36 }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 5, type: 'VEC3', min: [-1, -1, 0], max: [1, 1, 1] },
      { bufferView: 1, componentType: 5123, count: 18, type: 'SCALAR' }],
  });
}

test('takes an own OBJ or glTF, and says what is wrong with a bad one', { timeout: PATIENCE }, async () => {
  await open('?url=photo.sateen');
  const sphere = await pixels();
  const dropText = (name, text) => drop([[name, Buffer.from(text).toString('base64')]]);
  const shown = () => page.waitForFunction(() => !document.querySelector('input[name="shape"]:checked'));
  await dropText('pyramid.obj', pyramidObj());
  await shown();
  const obj = await pixels();
  assert.ok(difference(sphere, obj) > 1, 'the OBJ is not shown');
  assert.ok(deviation(obj) > 2, 'the OBJ has no texture');
  await page.check('input[value="sphere"]', { force: true });
  await dropText('pyramid.gltf', pyramidGltf());
  await shown();
  const gltf = await pixels();
  assert.ok(difference(sphere, gltf) > 1 && deviation(gltf) > 2, 'the glTF is not shown');
  await dropText('broken.gltf', '{"asset":');
  await page.waitForFunction(() => document.getElementById('message').textContent.startsWith('broken.gltf'));
});

test('the exported page opens from a disk', { timeout: PATIENCE }, async (t) => {
  if (!existsSync(join(process.env.SATEEN, '../../share/sateen/viewer.html'))) {
    t.skip('the program has no viewer');
    return;
  }
  const path = join(folder, 'whole.html');
  sateen('export', join(folder, 'measured.sateen'), '-o', path);
  assert.ok(readFileSync(path).length <= 1_000_000);
  await watched.context.setOffline(true);
  await page.goto(pathToFileURL(path).href);
  await page.waitForFunction(() => document.body.dataset.ready === 'true');
  assert.ok(deviation(await pixels()) > 4);
  assert.deepEqual(watched.requests.filter((url) => /^https?:/.test(url)), []);
});

test('every control can be named and reached', { timeout: PATIENCE }, async () => {
  await open('?url=measured.sateen');
  const unnamed = await page.evaluate(() =>
    [...document.querySelectorAll('button, input:not([hidden]), select, [tabindex="0"]')]
      .filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.labels?.length))
      .map((e) => e.outerHTML));
  assert.deepEqual(unnamed, []);
});
