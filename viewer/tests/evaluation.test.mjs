// SPDX-License-Identifier: Apache-2.0
// The shader against the reference evaluation: `sateen render` of the same plane.
import assert from 'node:assert/strict';
import { basename, join } from 'node:path';
import { after, before, test } from 'node:test';

import { closeWatched, launch, PATIENCE, pixelsOf, serve, watchedPage } from './browser.mjs';
import {
  bumpyMaterial, deltaE, measuredMaterial, photographMaterial, readPng, ROOT, sateen, scratch, wovenMaterial,
} from './support.mjs';

const folder = scratch(after);
const MATERIALS = {
  photograph: photographMaterial, pattern: wovenMaterial, measured: measuredMaterial, relief: bumpyMaterial,
};
let browser;
let server;

before(async () => {
  server = await serve((path) => (path === '/' ? join(ROOT, 'viewer/dist/viewer.html') : join(folder, path)));
  browser = await launch();
}, { timeout: PATIENCE });
after(async () => {
  await browser?.close();
  server?.close();
});

/** Which pixels see the inside of the plane, by the camera of render/renderer.cpp. */
function seesPlane(theta, phi, width, height) {
  const [t, p] = [theta, theta === 0 ? -90 : phi].map((degrees) => (degrees * Math.PI) / 180);
  const half = Math.tan((14 * Math.PI) / 180);
  const distance = 1.06 / Math.sin((14 * Math.PI) / 180);
  const eye = [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
  const up = [-Math.cos(t) * Math.cos(p), -Math.cos(t) * Math.sin(p), Math.sin(t)];
  const right = [-Math.sin(p), Math.cos(p), 0];
  return (r, c) => {
    const [x, y] = [2 * c + 1 - width, height - 2 * r - 1].map((at) => (at / Math.min(width, height)) * half);
    const ray = eye.map((e, i) => -e + x * right[i] + y * up[i]);
    const reach = (-distance * eye[2]) / ray[2];
    return [0, 1].every((i) => Math.abs(distance * eye[i] + reach * ray[i]) < 0.96);
  };
}

/** View and light in degrees; repeats of the tile; 1 for displacement and shadows. */
const SCENES = {
  photograph: ['0,0,0,0,1,0', '45,270,50,225,1,0'],
  pattern: ['0,0,30,100,1,0', '50,200,10,0,1,0'],
  measured: ['20,30,35,140,1,0', '60,270,55,225,1,0', '40,100,70,300,1,0'],
  relief: ['0,0,25,10,1,0', '30,300,60,150,1,0', '45,200,65,20,1,1'],
};

for (const [name, make] of Object.entries(MATERIALS))
  test(`pixels change with view and light as the reference says: ${name}`, { timeout: PATIENCE }, async () => {
    const material = make(folder);
    if (name === 'relief') assert.ok(JSON.parse(sateen('info', material, '--json')).surface, 'no range map');
    const watched = await watchedPage(browser, { viewport: { width: 776, height: 288 } });
    const { page } = watched;
    await page.goto(`${server.origin}/?url=${basename(material)}&reference=${SCENES[name][0]}`);
    await page.waitForFunction(() => document.body.dataset.started === 'true');
    assert.equal(await page.textContent('#message'), '');
    for (const scene of SCENES[name]) {
      await page.evaluate((detail) => dispatchEvent(new CustomEvent('reference', { detail })), scene);
      const shown = await pixelsOf(page);
      const [viewTheta, viewPhi, lightTheta, lightPhi, , marched] = scene.split(',').map(Number);
      const path = join(folder, 'reference.png');
      sateen('render', material, '-o', path, '--mesh', 'plane', '--scale', 1, '--texture', 256, '--exposure', 1,
        '--size', `${shown.width}x${shown.height}`, '--view', `${viewTheta},${viewPhi}`,
        '--light', `${lightTheta},${lightPhi}`, ...(marched ? ['--relief', 'marched'] : []));
      const { samples } = readPng(path);
      const inside = seesPlane(viewTheta, viewPhi, shown.width, shown.height);
      let [sum, count] = [0, 0];
      for (let r = 0; r < shown.height; ++r)
        for (let c = 0; c < shown.width; ++c) {
          if (!inside(r, c)) continue;
          const i = r * shown.width + c;
          sum += deltaE(shown.data.slice(4 * i, 4 * i + 3), [...samples.subarray(3 * i, 3 * i + 3)]);
          ++count;
        }
      assert.ok(count > 10_000, `only ${count} pixels of the plane`);
      if (process.env.VERBOSE) console.log(name, scene, (sum / count).toFixed(3));
      assert.ok(sum / count <= 2, `${scene}: mean ΔE ${(sum / count).toFixed(2)}`);
      
    }
    await closeWatched(watched, server.origin);
  });
