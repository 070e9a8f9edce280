// SPDX-License-Identifier: Apache-2.0
// What the tests share: the program, materials made by it, and PNG files read back.
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
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

/**
 * A measurement: pictures named in a directions.csv. @param value  (light, view, row, col,
 * band), directions in degrees, to an 8-bit sample
 */
function writeMeasurement(folder, side, lights, views, value) {
  mkdirSync(folder, { recursive: true });
  const lines = [];
  lights.forEach((light, l) => views.forEach((view, v) => {
    const name = `l${l}v${v}.tif`;
    writeTiff(join(folder, name), side, side, (r, c, b) => value(light, view, r, c, b));
    lines.push([name, ...view, ...light].join());
  }));
  writeFileSync(join(folder, 'directions.csv'), `file,theta_v,phi_v,theta_i,phi_i\n${lines.join('\n')}\n`);
}

const radians = (degrees) => (degrees * Math.PI) / 180;
const FIVE = [[0, 0], [60, 0], [60, 90], [60, 180], [60, 270]];

/** A material of 5 views × 5 lights, brighter along the light and bluer towards grazing views. */
export function measuredMaterial(folder) {
  const noise = smoothNoise(48, 48, 2);
  writeMeasurement(folder, 48, FIVE, FIVE, ([tl, pl], [tv, pv], r, c, b) => {
    const shade = Math.cos(radians(tl)) * (1 + 0.3 * Math.cos(radians(pl - pv)) * (tl > 0));
    return (150 * [1, 0.7, 0.4 * (1 + 0.5 * (tv > 0))][b] + 50 * noise(r, c)) * shade ** (1 / 2.2);
  });
  const path = join(folder, 'measured.sateen');
  sateen('model', folder, '-o', path, '--subspaces', 6);
  return path;
}

/** A matt material with bumps, 5 views × 13 lights, from which a range map is estimated. */
export function bumpyMaterial(folder) {
  const side = 64;
  const lights = [[0, 0], ...[25, 45, 60].flatMap((t) => [10, 100, 190, 280].map((p) => [t, p]))];
  const grain = smoothNoise(side, side, 3);
  const turn = (2 * Math.PI) / side;
  writeMeasurement(join(folder, 'bumps'), side, lights, FIVE, ([tl, pl], _, r, c, b) => {
    const [p, q] = [0.5 * Math.cos(4 * turn * c), 0.35 * Math.sin(3 * turn * r)];
    const l = [Math.sin(radians(tl)) * Math.cos(radians(pl)), Math.sin(radians(tl)) * Math.sin(radians(pl)), Math.cos(radians(tl))];
    const shading = Math.max(0, (-p * l[0] - q * l[1] + l[2]) / Math.hypot(p, q, 1));
    return 255 * ([0.55, 0.4, 0.3][b] * (1 + 0.35 * grain(r, c)) * shading) ** (1 / 2.2);
  });
  const path = join(folder, 'bumpy.sateen');
  sateen('model', join(folder, 'bumps'), '-o', path, '--subspaces', 5, '--surface', 'stereo');
  return path;
}

/** A material of 9 views × 9 lights and 20 subspaces, with bumps. */
export function manyMaterial(folder) {
  const side = 64;
  const ring = [[0, 0], ...[35, 65].flatMap((t) => [20, 110, 200, 290].map((p) => [t, p]))];
  const grain = smoothNoise(side, side, 5);
  const turn = (2 * Math.PI) / side;
  writeMeasurement(join(folder, 'many'), side, ring, ring, ([tl, pl], [tv, pv], r, c, b) => {
    const [p, q] = [0.5 * Math.cos(4 * turn * c), 0.35 * Math.sin(3 * turn * r)];
    const l = [Math.sin(radians(tl)) * Math.cos(radians(pl)), Math.sin(radians(tl)) * Math.sin(radians(pl)), Math.cos(radians(tl))];
    const shading = Math.max(0, (-p * l[0] - q * l[1] + l[2]) / Math.hypot(p, q, 1));
    const sheen = 1 + 0.5 * Math.sin(radians(tv)) * Math.cos(radians(pl - pv));
    return 255 * ([0.5, 0.4, 0.3 + 0.1 * (tv > 0)][b] * sheen * (1 + 0.35 * grain(r, c)) * shading) ** (1 / 2.2);
  });
  const path = join(folder, 'many.sateen');
  sateen('model', join(folder, 'many'), '-o', path, '--subspaces', 20, '--surface', 'stereo');
  return path;
}

/** A material of a photograph with a pattern that repeats every 13.5 pixels. */
export function wovenMaterial(folder) {
  const draw = random(4);
  const wave = Array.from({ length: 160 }, (_, i) => Math.sin((2 * Math.PI * i) / 13.5));
  writeTiff(join(folder, 'weave.tif'), 160, 160, (r, c, b) =>
    110 + [60, 50, 35][b] * (Math.max(wave[r], wave[c]) + 0.3 * wave[r] * wave[c]) + 12 * draw());
  const path = join(folder, 'woven.sateen');
  sateen('model', join(folder, 'weave.tif'), '-o', path);
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

/** The colour difference ΔE*ab of two 8-bit sRGB colours. */
export function deltaE(a, b) {
  const [p, q] = [lab(a), lab(b)];
  return Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

function lab(code) {
  const [r, g, b] = code.map((c) => (c <= 0.04045 * 255 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
  const f = (t) => (t > 216 / 24389 ? Math.cbrt(t) : ((24389 / 27) * t + 16) / 116);
  const [x, y, z] = [
    f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505), f(0.2126 * r + 0.7152 * g + 0.0722 * b),
    f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089)];
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}
