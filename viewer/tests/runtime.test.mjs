// SPDX-License-Identifier: Apache-2.0
// The WebAssembly runtime draws what the program draws, and no file makes it trap.
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { build } from 'esbuild';

import {
  measuredMaterial, payloadOf, photographMaterial, random, readPng, ROOT, sateen, scratch, wovenMaterial,
} from './support.mjs';

const folder = scratch(after);
let Runtime;
let makeBasis;
let textureMoments;
let module;
let photograph;
let measured;
let woven;

before(async () => {
  await build({
    entryPoints: ['runtime', 'basis'].map((name) => join(ROOT, `viewer/src/lib/${name}.ts`)),
    bundle: true, format: 'esm', outdir: folder, outExtension: { '.js': '.mjs' }, logLevel: 'error',
  });
  ({ Runtime } = await import(join(folder, 'runtime.mjs')));
  ({ makeBasis, textureMoments } = await import(join(folder, 'basis.mjs')));
  module = await WebAssembly.compile(readFileSync(join(ROOT, 'build/wasm/bin/sateen.wasm')));
  photograph = photographMaterial(folder);
  measured = measuredMaterial(folder);
  woven = wovenMaterial(folder);
});

const encode = (v) => {
  const c = v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
  return Math.floor(255 * Math.min(1, Math.max(0, c)) + 0.5);
};

/** Compares one drawn texture with the program's PNG of it. */
function assertSame(texture, bands, path) {
  const { rows, cols, channels, samples } = readPng(path);
  assert.equal(texture.length, bands * rows * cols);
  let equal = 0;
  let furthest = 0;
  for (let i = 0; i < rows * cols; ++i)
    for (let b = 0; b < channels; ++b) {
      const off = Math.abs(encode(texture[b * rows * cols + i]) - samples[i * channels + b]);
      equal += off === 0;
      furthest = Math.max(furthest, off);
    }
  assert.ok(furthest <= 1, `${path}: a sample is off by ${furthest}`);
  const share = equal / (rows * cols * channels);
  assert.ok(share >= 0.999, `${path}: only ${share} of the samples are equal`);
}

for (const [what, rows, cols] of [['one transform', 128, 128], ['a size of no transform', 62, 94]])
  test(`draws the program's texture: ${what}`, async () => {
    const path = join(folder, `${rows}.png`);
    sateen('synthesise', photograph, '-o', path, '--size', `${cols}x${rows}`, '--tileable', '--seed', '81985529216486895');
    const material = (await Runtime.create(module)).load(payloadOf(photograph));
    material.draw({ rows, cols, seed: 81985529216486895n }, (_, texture) => assertSame(texture, 3, path));
  });

const modulated = join(ROOT, 'tests/golden/v1/modulated.sateen');
for (const [what, path, part] of [['pattern', () => woven, 'structure'], ['modulation', () => modulated, 'modulation']])
  for (const [rows, cols] of [[128, 128], [96, 150]])
    test(`draws a ${what} as the program does, ${cols} x ${rows}`, async () => {
      const picture = join(folder, `${part}${rows}.png`);
      assert.ok(JSON.parse(sateen('info', path(), '--json')).payload_bytes[part] > 0);
      sateen('synthesise', path(), '-o', picture, '--size', `${cols}x${rows}`, '--tileable', '--seed', '7');
      const material = (await Runtime.create(module)).load(payloadOf(path()));
      material.draw({ rows, cols, seed: 7n }, (k, texture) => {
        if (k === 0) assertSame(texture, material.description.bands, picture);
      });
    });

test('draws every subspace of a measurement as the program does', async () => {
  sateen('synthesise', measured, '-o', join(folder, 'all'), '--all', '--size', '64x64');
  const material = (await Runtime.create(module)).load(payloadOf(measured));
  const drawn = [];
  material.draw({ rows: 64, cols: 64 }, (k, texture) => {
    drawn.push(k);
    assertSame(texture, 3, join(folder, `all/subspace_${String(k).padStart(2, '0')}.png`));
  });
  assert.deepEqual(drawn, material.description.subspaces.map((_, k) => k));
  assert.ok(drawn.length > 1);
});

test('describes the material', async () => {
  const { description } = (await Runtime.create(module)).load(payloadOf(measured));
  const info = JSON.parse(sateen('info', measured, '--json'));
  assert.equal(description.views.length, 5);
  assert.equal(description.lights.length, 5);
  assert.equal(description.index.length, 25);
  assert.equal(description.bands, 3);
  assert.ok(description.index.every((k) => k >= 0 && k < description.subspaces.length));
  assert.ok(JSON.stringify(info).includes(description.name));
  for (const subspace of description.subspaces) {
    assert.equal(subspace.T.length, 9);
    assert.equal(subspace.scale.length, 3);
  }
});

test('finds the subspace that the program finds', async () => {
  const material = (await Runtime.create(module)).load(payloadOf(measured));
  for (const [view, light] of [[[0, 0], [0, 0]], [[50, 80], [40, 200]], [[70, 10], [10, 350]]]) {
    const said = JSON.parse(sateen('synthesise', measured, '-o', join(folder, 'n.png'), '--size', 8,
      '--view', view.join(), '--light', light.join(), '--json'));
    const radians = (d) => d.map((x) => (x * Math.PI) / 180);
    assert.equal(material.nearestSubspace(radians(view), radians(light)), said.subspace);
  }
});

test('fields are standard normal', async () => {
  const material = (await Runtime.create(module)).load(payloadOf(photograph));
  material.draw({ rows: 128, cols: 128, fieldsOnly: true }, (_, fields) => {
    for (let plane = 0; plane < 3; ++plane) {
      const g = fields.subarray(plane * 128 * 128, (plane + 1) * 128 * 128);
      const mean = g.reduce((s, x) => s + x, 0) / g.length;
      const variance = g.reduce((s, x) => s + (x - mean) ** 2, 0) / g.length;
      assert.ok(Math.abs(mean) < 1e-3 && Math.abs(variance - 1) < 1e-3, `${mean} ${variance}`);
    }
  });
});

/** All textures of a material on a torus of 64 x 64. */
function texturesOf(material) {
  const textures = [];
  material.draw({ rows: 64, cols: 64 }, (_, texture) => textures.push(texture));
  return textures;
}

test('moments of textures are those of the runtime', async () => {
  const material = (await Runtime.create(module)).load(payloadOf(measured));
  const found = textureMoments(texturesOf(material), 3);
  const expected = material.moments(64, 64);
  for (const part of ['mean', 'shape'])
    found[part].forEach((x, i) => assert.ok(Math.abs(x - expected[part][i]) < 2e-3 * (1 + Math.abs(x)), `${part} ${i}: ${x}`));
});

test('the components give the textures back', async () => {
  for (const path of [photograph, measured, woven]) {
    const material = (await Runtime.create(module)).load(payloadOf(path));
    const textures = texturesOf(material);
    const basis = makeBasis(textures, 3, { rows: 64, cols: 64 });
    assert.ok(basis.left <= 0.02, `${path}: ${basis.left}`);
    const count = 4 * basis.groups.length;
    let [squares, most] = [0, 0];
    textures.forEach((texture, k) => {
      for (let c = 0; c < 3; ++c) {
        const mean = basis.moments.mean[4 * k + c];
        const rows = basis.coefficients.subarray((3 * k + c) * count, (3 * k + c + 1) * count);
        for (let i = 0; i < 4096; ++i) {
          let x = mean;
          for (let r = 0; r < count; ++r) {
            const t = basis.groups[r >> 2].levels[0][4 * i + (r & 3)] / 255;
            x += rows[r] * (Math.exp(basis.exponent[r] * t) + basis.offset[r]);
          }
          const off = Math.abs(x - texture[c * 4096 + i]) / mean;
          squares += off * off;
          most = Math.max(most, off);
        }
      }
    });
    const off = Math.sqrt(squares / (textures.length * 3 * 4096));
    assert.ok(off < 0.03 && most < 0.3, `${path}: off by ${off}, at most ${most}`);
    // The coarsest level is the mean: φ = 0.
    for (let r = 0; r < Math.min(count, 3); ++r)
      assert.ok(Math.abs(basis.groups[0].levels.at(-1)[r] / 255 - basis.farMiddle[r]) < 0.01);
  }
});

test('drawing stops when it is told to, and an impossible size is refused', async () => {
  const material = (await Runtime.create(module)).load(payloadOf(measured));
  let taken = 0;
  assert.throws(() => material.draw({ rows: 16, cols: 16 }, () => ++taken < 2), /cancelled/);
  assert.equal(taken, 2);
  assert.throws(() => material.draw({ rows: 0, cols: 16 }, () => true), /size|pixels/);
  assert.throws(() => material.draw({ rows: 1 << 20, cols: 16 }, () => true), /at most 4096/);
  assert.throws(() => material.draw({ rows: 16, cols: 16, subspaces: [99] }, () => true), /subspace 99/);
});

/** The payload is refused with a message, or is a material that can be drawn. */
function assertHandled(runtime, payload) {
  try {
    const material = runtime.load(payload);
    if (material.description.pattern) {
      material.pattern(0);
      material.drawPhase(16, 16);
    }
    material.unload();
  } catch (error) {
    assert.equal(error.name, 'SateenError', `a trap: ${error}`);
    assert.ok(error.message.length > 0);
  }
}

test('every prefix of a file is refused', async () => {
  const runtime = await Runtime.create(module);
  const payload = payloadOf(measured);
  for (let size = 0; size < payload.length; size += size < 512 ? 1 : 7)
    assert.throws(() => runtime.load(payload.subarray(0, size)), { name: 'SateenError' });
});

test('altered bytes and rubbish give an error or a material, never a trap', async () => {
  const runtime = await Runtime.create(module);
  for (const [path, step] of [[photograph, 1], [woven, 3], [measured, 5]]) {
    const payload = payloadOf(path);
    for (let i = 0; i < payload.length; i += step) {
      const mask = [0x01, 0x80, 0xff, 0x10][i % 4];
      payload[i] ^= mask;
      assertHandled(runtime, payload);
      payload[i] ^= mask;
    }
  }
  const draw = random(5);
  for (let trial = 0; trial < 1000; ++trial)
    assertHandled(runtime, Uint8Array.from({ length: 400 * draw() }, () => 256 * draw()));
});

test('the module is small', () => {
  const packed = gzipSync(readFileSync(join(ROOT, 'build/wasm/bin/sateen.wasm')), { level: 9 });
  assert.ok(packed.length <= 250_000, `${packed.length} bytes`);
  assert.ok(statSync(join(ROOT, 'build/wasm/bin/sateen.wasm')).size > 10_000);
});
