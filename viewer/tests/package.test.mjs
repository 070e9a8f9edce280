// SPDX-License-Identifier: Apache-2.0
// The package `sateen` as another project has it: the example page with the built library.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';

import { closeWatched, launch, PATIENCE, pixelsOf, serve, watchedPage } from './browser.mjs';
import { bumpyMaterial, photographMaterial, ROOT, sateen, scratch, wovenMaterial } from './support.mjs';

const folder = scratch(after);
let browser;
let server;

before(async () => {
  const material = photographMaterial(folder);
  const woven = wovenMaterial(folder);
  const baked = join(folder, 'bumpy.glb');
  sateen('export', bumpyMaterial(folder), '-o', baked, '--size', '64x48');
  const files = { '/example/material.sateen': material, '/example/woven.sateen': woven, '/example/bumpy.glb': baked };
  server = await serve((path) => files[path] ?? join(ROOT, 'viewer', path));
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

test('no package asks for more than the Node of Debian 12', () => {
  const { packages } = JSON.parse(readFileSync(join(ROOT, 'viewer/package-lock.json'), 'utf8'));
  // Of ranges such as "^18.0.0 || >=20" one has to take 18: what "<", "-" and spaces would say does not occur.
  const takes18 = (range) => range.split('||').some((part) => {
    const [, sign, major] = /^(>=|\^)(\d+)(?:\.\d+)*$/.exec(part.trim()) ?? assert.fail(`cannot read "${range}"`);
    return sign === '^' ? Number(major) === 18 : Number(major) <= 18;
  });
  const tooNew = Object.entries(packages).filter(([, { engines }]) => engines?.node && !takes18(engines.node));
  assert.deepEqual(tooNew.map(([name, { engines }]) => `${name}: ${engines.node}`), []);
});

test('the baked glTF opens in the loader of three.js with its three maps', { timeout: PATIENCE }, async () => {
  const watched = await watchedPage(browser, { viewport: { width: 200, height: 120 } });
  await watched.page.goto(`${server.origin}/example/index.html`);
  await watched.page.waitForFunction(() => document.body.dataset.drawn === 'true');
  const { count, maps, roughness } = await watched.page.evaluate(async () => {
    const { GLTFLoader } = await import('../node_modules/three/examples/jsm/loaders/GLTFLoader.js');
    const { scene } = await new GLTFLoader().loadAsync('bumpy.glb');
    const meshes = [];
    scene.traverse((object) => object.isMesh && meshes.push(object));
    const { material } = meshes[0];
    /** Size, and the means of red, green and blue. */
    const measure = ({ image, colorSpace }) => {
      const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
      context.drawImage(image, 0, 0);
      const { data } = context.getImageData(0, 0, image.width, image.height);
      const mean = [0, 1, 2].map((c) => data.reduce((sum, x, i) => sum + (i % 4 === c ? x : 0), 0) / (data.length / 4));
      return { width: image.width, height: image.height, colorSpace, mean };
    };
    const uses = { colour: material.map, normal: material.normalMap, roughness: material.roughnessMap };
    return {
      count: meshes.length, roughness: material.roughness,
      maps: Object.fromEntries(Object.entries(uses).map(([use, map]) => [use, map && measure(map)])),
    };
  });
  assert.equal(count, 1);
  assert.equal(roughness, 1);
  for (const [use, map] of Object.entries(maps)) {
    assert.ok(map, `no map of ${use}`);
    assert.deepEqual([map.width, map.height], [64, 48], use);
  }
  assert.equal(maps.colour.colorSpace, 'srgb');
  const [red, , blue] = maps.colour.mean;
  assert.ok(red > blue + 10, `a warm material of colour ${maps.colour.mean}`);
  const [x, y, z] = maps.normal.mean;
  assert.ok(Math.abs(x - 127.5) < 12 && Math.abs(y - 127.5) < 12 && z > 180, `normals of mean ${maps.normal.mean}`);
  assert.ok(maps.roughness.mean[1] > 25, `roughness of mean ${maps.roughness.mean}`);
  await closeWatched(watched, server.origin);
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

/**
 * In the page: a plane seen from straight in front, 32 x 32 pixels of `texels` texels each. Frames are moved by eighths
 * of a pixel. Deviation of pixels over frames, and the mean of all: as drawn, without levels, and by 16 x 16 samples a pixel.
 */
async function distantPlane([url, texels]) {
  const { loadMaterial, SateenMaterial } = await import('sateen');
  const three = await import('three');
  const [PIXELS, SAMPLES, FRAMES] = [32, 16, 8];
  const sateen = await SateenMaterial.create(await loadMaterial(url), { texelsPerUv: [PIXELS * texels, PIXELS * texels] });
  const scene = new three.Scene();
  const lamp = new three.DirectionalLight(0xffffff, 2);
  lamp.position.set(1, 1, 2);
  scene.add(new three.Mesh(new three.PlaneGeometry(4, 4).scale(1, 1, 1), sateen), lamp);
  const { uv } = scene.children[0].geometry.attributes;
  for (let i = 0; i < uv.count; ++i) uv.setXY(i, 2 * uv.getX(i), 2 * uv.getY(i));
  const camera = new three.OrthographicCamera(-1, 1, 1, -1, 0, 10);
  camera.position.z = 5;
  const renderer = new three.WebGLRenderer();
  renderer.outputColorSpace = three.LinearSRGBColorSpace;
  const frame = (side, shift) => {
    renderer.setSize(side, side);
    camera.setViewOffset(side, side, shift, 0, side, side);
    renderer.render(scene, camera);
    const gl = renderer.getContext();
    const data = new Uint8Array(4 * side * side);
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, data);
    return Float64Array.from({ length: side * side }, (_, i) => data[4 * i + 1]);
  };
  const frames = () => Array.from({ length: FRAMES }, (_, f) => frame(PIXELS, f / FRAMES));
  const measure = (list) => {
    let [variance, mean] = [0, 0];
    for (let i = 0; i < list[0].length; ++i) {
      const m = list.reduce((s, f) => s + f[i], 0) / list.length;
      variance += list.reduce((s, f) => s + (f[i] - m) ** 2, 0) / list.length / list[0].length;
      mean += m / list[0].length;
    }
    return { shimmer: Math.sqrt(variance), mean };
  };
  const drawn = measure(frames());
  const sampled = [];
  for (let f = 0; f < FRAMES; ++f) {
    const side = PIXELS * SAMPLES;
    const fine = frame(side, (f * SAMPLES) / FRAMES);
    const out = new Float64Array(PIXELS * PIXELS);
    fine.forEach((x, i) => (out[Math.floor(i / side / SAMPLES) * PIXELS + Math.floor((i % side) / SAMPLES)] += x / SAMPLES ** 2));
    sampled.push(out);
  }
  const ideal = measure(sampled);
  for (const [name, { value }] of Object.entries(sateen.uniforms))
    if (/^(basis|cells)/.test(name) && value) {
      value.minFilter = three.LinearFilter;
      value.needsUpdate = true;
    }
  return { drawn, ideal, without: measure(frames()) };
}

for (const name of ['material', 'woven'])
  test(`a distant plane does not shimmer, and keeps its brightness: ${name}`, { timeout: PATIENCE }, async () => {
    const watched = await watchedPage(browser, { viewport: { width: 200, height: 120 } });
    await watched.page.goto(`${server.origin}/example/index.html`);
    await watched.page.waitForFunction(() => document.body.dataset.drawn === 'true');
    const { drawn, ideal, without } = await watched.page.evaluate(distantPlane, [`${name}.sateen`, 8]);
    const text = JSON.stringify({ drawn, ideal, without });
    if (process.env.VERBOSE) console.log(name, text);
    assert.ok(drawn.shimmer <= 1.5 * ideal.shimmer + 0.5, text);
    assert.ok(without.shimmer > 2 * drawn.shimmer, `without levels it should shimmer: ${text}`);
    assert.ok(Math.abs(drawn.mean / ideal.mean - 1) < 0.06, text);
    await closeWatched(watched, server.origin);
  });
