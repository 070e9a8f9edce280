// SPDX-License-Identifier: Apache-2.0
// What the tests share: the program, materials made by it, and PNG files read back.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gunzipSync, inflateSync } from 'node:zlib';

export const ROOT = fileURLToPath(new URL('../..', import.meta.url));
export const PROGRAM = process.env.SATEEN ?? join(ROOT, 'build/release/bin/sateen');

export function sateen(...args) {
  const run = spawnSync(PROGRAM, args.map(String), { encoding: 'utf8' });
  if (run.status !== 0) throw new Error(`sateen ${args.join(' ')}: ${run.stderr || run.error}`);
  return run.stdout;
}

/** A folder that goes when the tests have ended. */
export function scratch(after) {
  const folder = mkdtempSync(join(tmpdir(), 'sateen-'));
  after(() => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** A small generator with a seed (mulberry32). */
export function random(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** A portable pixmap's samples as the program's tests make them, written as an 8-bit TIFF. */
export function writeTiff(path, rows, cols, sample) {
  const header = 8;
  const entries = [
    [256, 4, 1, cols], [257, 4, 1, rows], [258, 3, 1, 8], [259, 3, 1, 1], [262, 3, 1, 2],
    [273, 4, 1, 0], [277, 3, 1, 3], [278, 4, 1, rows], [279, 4, 1, rows * cols * 3],
  ];
  const directory = 2 + 12 * entries.length + 4;
  const file = Buffer.alloc(header + directory + rows * cols * 3);
  file.write('II*\0', 'latin1');
  file.writeUInt32LE(header, 4);
  file.writeUInt16LE(entries.length, header);
  entries.forEach(([tag, type, count, value], i) => {
    const at = header + 2 + 12 * i;
    file.writeUInt16LE(tag, at);
    file.writeUInt16LE(type, at + 2);
    file.writeUInt32LE(count, at + 4);
    file.writeUInt32LE(tag === 273 ? header + directory : value, at + 8);
  });
  for (let r = 0, at = header + directory; r < rows; ++r)
    for (let c = 0; c < cols; ++c)
      for (let b = 0; b < 3; ++b) file[at++] = Math.max(0, Math.min(255, Math.round(sample(r, c, b))));
  writeFileSync(path, file);
}

/** Smoothed noise, (rows, cols), from -1 to 1, toroidal. */
function smoothNoise(rows, cols, seed) {
  const draw = random(seed);
  const noise = Float32Array.from({ length: rows * cols }, () => 2 * draw() - 1);
  const at = (r, c) => noise[((r + rows) % rows) * cols + ((c + cols) % cols)];
  return (r, c) => {
    let sum = 0;
    for (let i = -2; i <= 2; ++i) for (let j = -1; j <= 1; ++j) sum += at(r + i, c + j);
    return sum / 4;
  };
}

/** A material of one photograph. */
export function photographMaterial(folder) {
  const noise = smoothNoise(96, 96, 1);
  const tint = [1, 0.75, 0.5];
  writeTiff(join(folder, 'photo.tif'), 96, 96, (r, c, b) => 130 * tint[b] + 60 * noise(r, c));
  const path = join(folder, 'photo.sateen');
  sateen('model', join(folder, 'photo.tif'), '-o', path);
  return path;
}

/** A material of 5 views × 5 lights, brighter along the light and bluer towards grazing views. */
export function measuredMaterial(folder) {
  const noise = smoothNoise(48, 48, 2);
  const directions = [[0, 0], [60, 0], [60, 90], [60, 180], [60, 270]];
  const lines = [];
  directions.forEach(([tl, pl], l) => directions.forEach(([tv, pv], v) => {
    const name = `l${l}v${v}.tif`;
    const shade = Math.cos((tl * Math.PI) / 180) * (1 + 0.3 * Math.cos(((pl - pv) * Math.PI) / 180) * (tl > 0));
    const blue = 1 + 0.5 * (tv > 0);
    writeTiff(join(folder, name), 48, 48, (r, c, b) =>
      (150 * [1, 0.7, 0.4 * blue][b] + 50 * noise(r, c)) * shade ** (1 / 2.2));
    lines.push(`${name},${tv},${pv},${tl},${pl}`);
  }));
  writeFileSync(join(folder, 'directions.csv'), `file,theta_v,phi_v,theta_i,phi_i\n${lines.join('\n')}\n`);
  const path = join(folder, 'measured.sateen');
  sateen('model', folder, '-o', path, '--subspaces', 6);
  return path;
}

export const payloadOf = (path) => new Uint8Array(gunzipSync(readFileSync(path)));

/** {rows, cols, samples: (rows, cols, 3)} of an 8-bit RGB PNG. */
export function readPng(path) {
  const data = readFileSync(path);
  const idat = [];
  let [rows, cols] = [0, 0];
  for (let at = 8; at < data.length;) {
    const length = data.readUInt32BE(at);
    const kind = data.toString('latin1', at + 4, at + 8);
    const body = data.subarray(at + 8, at + 8 + length);
    if (kind === 'IHDR') [cols, rows] = [body.readUInt32BE(0), body.readUInt32BE(4)];
    if (kind === 'IDAT') idat.push(body);
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(idat));
  const stride = raw.length / rows - 1;
  const channels = stride / cols;
  const out = new Uint8Array(rows * stride);
  const paeth = (a, b, c) => {
    const [pa, pb, pc] = [Math.abs(b - c), Math.abs(a - c), Math.abs(a + b - 2 * c)];
    return pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
  };
  for (let r = 0; r < rows; ++r) {
    const filter = raw[r * (stride + 1)];
    for (let i = 0; i < stride; ++i) {
      const left = i >= channels ? out[r * stride + i - channels] : 0;
      const up = r > 0 ? out[(r - 1) * stride + i] : 0;
      const corner = r > 0 && i >= channels ? out[(r - 1) * stride + i - channels] : 0;
      const guess = [0, left, up, (left + up) >> 1, paeth(left, up, corner)][filter];
      out[r * stride + i] = raw[r * (stride + 1) + 1 + i] + guess;
    }
  }
  return { rows, cols, channels, samples: out };
}
