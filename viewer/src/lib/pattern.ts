// SPDX-License-Identifier: Apache-2.0
// The pattern of a material as textures for sateen.glsl: cells, displacement, tone curves.
import {
  DataArrayTexture, DataTexture, DataUtils, HalfFloatType, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping,
  RGBAFormat, type Texture,
} from 'three';

import { CELL_VALUES, type MaterialData, type PatternPhase } from './runtime';
import { LEVELS, type Range } from './textures';

const mixing = (i: number, j: number): number => 6 + (i * (i - 1)) / 2 + j;

/** m, s and l of one plane. */
interface PlaneMoments {
  /** Of m, and what of it averages over 2 × 2, 4 × 4, … samples of the table hide. */
  variance: number;
  hidden: number[];
  /** Means of s², and of l² from each plane before it. */
  power: number;
  mixed: number[];
  low: number;
  high: number;
}

function momentsOf(table: Float32Array, rows: number, cols: number, plane: number): PlaneMoments {
  let level: Float32Array = new Float32Array(rows * cols);
  let [power, low, high] = [0, Infinity, -Infinity];
  const mixed = Array.from({ length: plane }, () => 0);
  for (let i = 0; i < level.length; ++i) {
    const at = CELL_VALUES * i;
    level[i] = table[at + plane]!;
    power += table[at + 3 + plane]! ** 2 / level.length;
    mixed.forEach((_, j) => { mixed[j]! += table[at + mixing(plane, j)]! ** 2 / level.length; });
    [low, high] = [Math.min(low, level[i]!), Math.max(high, level[i]!)];
  }
  const mean = level.reduce((sum, x) => sum + x, 0) / level.length;
  const spread = (values: Float32Array): number => values.reduce((sum, x) => sum + (x - mean) ** 2, 0) / values.length;
  const variance = spread(level);
  const hidden = [0];
  let [r, c] = [rows, cols];
  while (r > 1 && c > 1 && hidden.length < 12) {
    const [hr, hc] = [r >> 1, c >> 1];
    const next = new Float32Array(hr * hc);
    for (let i = 0; i < hr; ++i)
      for (let j = 0; j < hc; ++j) {
        const at = 2 * i * c + 2 * j;
        next[i * hc + j] = (level[at]! + level[at + 1]! + level[at + c]! + level[at + c + 1]!) / 4;
      }
    [level, r, c] = [next, hr, hc];
    hidden.push(Math.max(0, variance - spread(level)));
  }
  return { variance, hidden, power, mixed, low, high };
}

/** What of each plane a level hides, and all of it: (subspaces, LEVELS, 3), (subspaces, 3). */
export interface PlaneVariance {
  hidden: Float32Array;
  all: Float32Array;
}

/** Of fields alone: scale² (1 - σ²). @param kept  share of the variance that each level keeps */
export function fieldVariance({ subspaces }: MaterialData, kept: Float32Array): PlaneVariance {
  const hidden = new Float32Array(kept.length);
  const all = new Float32Array(3 * subspaces.length);
  subspaces.forEach(({ scale }, k) => scale.forEach((s, i) => {
    all[3 * k + i] = s * s;
    for (let m = 0; m < LEVELS; ++m) {
      const at = (k * LEVELS + m) * 3 + i;
      hidden[at] = s * s * (1 - kept[at]!);
    }
  }));
  return { hidden, all };
}

export interface PatternTextures {
  cells: DataArrayTexture;
  ranges: Range[][];
  variance: PlaneVariance;
}

/** @param tables  of every subspace, (rows, cols, CELL_VALUES) */
export function patternTextures(data: MaterialData, tables: Float32Array[], kept: Float32Array): PatternTextures {
  const { rows, cols, inverse } = data.pattern!;
  const half = DataUtils.toHalfFloat;
  const texels = new Uint16Array(4 * rows * cols * 3 * tables.length);
  const fields = fieldVariance(data, kept);
  const variance = fieldVariance(data, kept);
  // Samples of the table that a pixel covers.
  const across = Math.sqrt(Math.abs(inverse[0]! * inverse[3]! - inverse[1]! * inverse[2]!) * rows * cols);
  const ranges = tables.map((table, k) => {
    for (let i = 0; i < rows * cols; ++i)
      for (let part = 0; part < 3; ++part)
        for (let plane = 0; plane < 3; ++plane)
          texels[4 * ((3 * k + part) * rows * cols + i) + plane] = half(table[CELL_VALUES * i + 3 * part + plane]!);
    return data.subspaces[k]!.scale.map((_, i) => {
      const m = momentsOf(table, rows, cols, i);
      const through = (of: Float32Array, first: number): number =>
        m.mixed.reduce((sum, power, j) => sum + of[first + j]! * power, of[first + i]! * m.power);
      const noise = through(fields.all, 3 * k);
      variance.all[3 * k + i] = m.variance + noise;
      for (let level = 0; level < LEVELS; ++level) {
        const at = (k * LEVELS + level) * 3 + i;
        const cellLevel = Math.max(0, Math.min(m.hidden.length - 1, Math.round(level + Math.log2(across))));
        variance.hidden[at] = through(fields.hidden, at - i) + (level === 0 ? 0 : m.hidden[cellLevel]!);
      }
      const reach = 3.2 * Math.sqrt(2 * noise);
      return { low: m.low - reach, length: m.high - m.low + 2 * reach };
    });
  });
  const cells = new DataArrayTexture(texels, cols, rows, 3 * tables.length);
  cells.format = RGBAFormat;
  cells.type = HalfFloatType;
  finish(cells);
  return { cells, ranges, variance };
}

/** Both components of B'⁻¹ D on its torus. */
export function phaseTexture({ shift }: PatternPhase, rows: number, cols: number): DataTexture {
  const sites = rows * cols;
  const texels = new Uint16Array(4 * sites);
  for (let i = 0; i < sites; ++i) {
    texels[4 * i] = DataUtils.toHalfFloat(shift[i]!);
    texels[4 * i + 1] = DataUtils.toHalfFloat(shift[sites + i]!);
  }
  return finish(new DataTexture(texels, cols, rows, RGBAFormat, HalfFloatType));
}

function finish<T extends Texture>(texture: T): T {
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
