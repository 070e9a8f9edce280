// SPDX-License-Identifier: Apache-2.0
// The package `sateen` as another project has it: the example page with the built library.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { closeWatched, launch, PATIENCE, pixelsOf, serve, watchedPage } from './browser.mjs';
import { photographMaterial, ROOT, scratch } from './support.mjs';

const folder = scratch(after);
let browser;
let server;

before(async () => {
  const material = photographMaterial(folder);
  server = await serve((path) => (path === '/example/material.sateen' ? material : join(ROOT, 'viewer', path)));
  browser = await launch();
}, { timeout: PATIENCE });
after(async () => {
  await browser?.close();
  server?.close();
});

test('the package has its declarations', () => {
  for (const name of ['sateen.js', 'index.d.ts', 'sateen_material.d.ts'])
    assert.ok(existsSync(join(ROOT, 'viewer/dist/lib', name)), name);
});

test('the example draws two meshes of the material, and one of three.js, under a lamp that moves',
  { timeout: PATIENCE }, async () => {
    const watched = await watchedPage(browser, { viewport: { width: 360, height: 160 } });
    const { page } = watched;
    await page.goto(`${server.origin}/example/index.html`);
    await page.waitForFunction(() => document.body.dataset.drawn === 'true');
    const first = await pixelsOf(page);
    const at = (picture, x) => {
      const i = 4 * (Math.round(picture.height / 2) * picture.width + Math.round(x * picture.width));
      return picture.data.slice(i, i + 3);
    };
    // Sphere, knot, box; the colour of the photograph is warm, the background and the box are not.
    const warmth = ([r, , b]) => r - b;
    assert.ok(warmth(at(first, 0.245)) > 30, `${at(first, 0.245)} on the sphere`);
    assert.ok(warmth(at(first, 0.755)) < 20, `${at(first, 0.755)} on the box`);
    // The lamp turns with the clock; how many frames a second bring depends on the machine.
    const changed = (later) => first.data.reduce((sum, x, i) => sum + Math.abs(x - later.data[i]), 0) / first.data.length;
    const until = Date.now() + PATIENCE / 4;
    let change = 0;
    while (change <= 0.3 && Date.now() < until) change = changed(await pixelsOf(page));
    assert.ok(change > 0.3, `the lamp moves, the picture changes by ${change}`);
    await closeWatched(watched, server.origin);
  });
