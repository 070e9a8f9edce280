// SPDX-License-Identifier: Apache-2.0
// A drawn material as textures for sateen.glsl.
import {
  ClampToEdgeWrapping, DataArrayTexture, DataTexture, DataUtils, HalfFloatType, LinearFilter,
  LinearMipmapLinearFilter, NearestFilter, RepeatWrapping, RGBAFormat, RGBAIntegerFormat, UnsignedByteType,
  UnsignedIntType, Vector4, type Texture,
} from 'three';

import type { MaterialData, SubspaceDescription, TextureMoments, ToneCurve } from './runtime';

/** Levels of the curves; coarser fields look like the last one. */
export const LEVELS = 8;
/** Texels a row in textures that are lists. */
export const LIST_COLS = 1024;
/** Of the fields' texture, at most. */
export const ANISOTROPY = 8;
/** Fields are stored from -G to G, curves in nodes 0.1 apart: both as in sateen.glsl. */
const G = 4.2;
const G_NODES = 85;

/** The fields of every subspace, toroidal, and how much of their variance each mip level keeps. */
export class FieldTexture {
  readonly texture: DataArrayTexture;
  /** (subspaces, LEVELS, 3) */
  readonly variance: Float32Array;
  private readonly data: Uint8Array;

  constructor(readonly side: number, private readonly bands: number, subspaces: number) {
    this.data = new Uint8Array(4 * side * side * subspaces);
    this.variance = new Float32Array(subspaces * LEVELS * 3).fill(1);
    this.texture = new DataArrayTexture(this.data, side, side, subspaces);
    this.texture.format = RGBAFormat;
    this.texture.type = UnsignedByteType;
    this.texture.wrapS = this.texture.wrapT = RepeatWrapping;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.generateMipmaps = true;
    this.texture.anisotropy = ANISOTROPY;
  }

  /** Takes the fields of one subspace, (bands, side, side). */
  set(subspace: number, fields: Float32Array): void {
    const sites = this.side * this.side;
    const at = 4 * sites * subspace;
    for (let band = 0; band < 3; ++band) {
      const plane = band < this.bands ? fields.subarray(band * sites, (band + 1) * sites) : undefined;
      for (let i = 0; i < sites; ++i)
        this.data[at + 4 * i + band] = plane ? Math.round(255 * (0.5 + 0.5 * clamp(plane[i]! / G, -1, 1))) : 128;
      if (plane) this.measureLevels(subspace, band, plane);
    }
    this.texture.needsUpdate = true;
  }

  /** The variance that is left after averages of 2 × 2, 4 × 4, … texels, as mip levels hold. */
  private measureLevels(subspace: number, band: number, plane: Float32Array): void {
    let [side, level] = [this.side, plane];
    for (let m = 0; m < LEVELS; ++m) {
      let squares = 0;
      for (const g of level) squares += g * g;
      const at = (subspace * LEVELS + m) * 3 + band;
      this.variance[at] = clamp(squares / level.length, 0, 1);
      if (side <= 1) continue;
      const half = side >> 1;
      const next = new Float32Array(half * half);
      for (let r = 0; r < half; ++r)
        for (let c = 0; c < half; ++c) {
          const i = 2 * r * side + 2 * c;
          next[r * half + c] = (level[i]! + level[i + 1]! + level[i + side]! + level[i + side + 1]!) / 4;
        }
      [side, level] = [half, next];
    }
  }
}

const clamp = (x: number, low: number, high: number): number => Math.min(high, Math.max(low, x));

/** q(g) of one plane: Marginal of material/material.hpp. */
export function marginal(scale: number, knots: number[], g: number): number {
  if (knots.length === 0) return scale * g;
  const x = ((clamp(g, -3, 3) + 3) / 6) * (knots.length - 1);
  const j = Math.min(Math.floor(x), knots.length - 2);
  return scale * (knots[j]! + (x - j) * (knots[j + 1]! - knots[j]!));
}

// Nodes and weights of the expectation over a standard normal value: a fine midpoint rule.
const NORMAL = Array.from({ length: 33 }, (_, i) => {
  const z = (i - 16) * 0.25;
  return [z, 0.25 * Math.exp(-z * z / 2) / Math.sqrt(2 * Math.PI)] as const;
});

/**
 * Rows (subspace, level) of a curve for each plane at G_NODES places. A level that hides some of the
 * variance has the mean over what it hides, E[f(x + σ z)], z ~ N(0, 1).
 */
function curveRows(
  subspaces: number, f: (k: number, band: number, node: number, hidden: number) => number,
  deviation: (k: number, band: number, level: number) => number, bands: number,
): DataTexture {
  const data = new Uint16Array(4 * G_NODES * subspaces * LEVELS);
  for (let k = 0; k < subspaces; ++k)
    for (let m = 0; m < LEVELS; ++m)
      for (let band = 0; band < bands; ++band) {
        const hidden = deviation(k, band, m);
        for (let n = 0; n < G_NODES; ++n) {
          let y = 0;
          if (hidden < 1e-4) y = f(k, band, n, 0);
          else for (const [z, w] of NORMAL) y += w * f(k, band, n, hidden * z);
          data[4 * ((k * LEVELS + m) * G_NODES + n) + band] = DataUtils.toHalfFloat(y);
        }
      }
  const texture = new DataTexture(data, G_NODES, subspaces * LEVELS, RGBAFormat, HalfFloatType);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

/** q(g), g from -G to G, by what each level keeps of the fields' variance. */
export function curveTexture(subspaces: SubspaceDescription[], variance: Float32Array): DataTexture {
  return curveRows(subspaces.length,
    (k, band, n, z) => marginal(subspaces[k]!.scale[band]!, subspaces[k]!.knots[band]!, -G + 0.1 * n + z),
    (k, band, m) => Math.sqrt(1 - variance[(k * LEVELS + m) * 3 + band]!), subspaces[0]!.mean.length);
}

/** c(x) of the pattern, x from low to high (subspaceRows), by what each level hides of x. */
export function toneCurveTexture(subspaces: SubspaceDescription[], ranges: Range[][], hidden: Float32Array): DataTexture {
  return curveRows(subspaces.length,
    (k, band, n, z) => {
      const { low, length } = ranges[k]![band]!;
      return applyCurve(subspaces[k]!.curves[band]!, low + (length * n) / (G_NODES - 1) + z);
    },
    (k, band, m) => Math.sqrt(hidden[(k * LEVELS + m) * 3 + band]!), subspaces[0]!.mean.length);
}

/** apply(ToneCurve, x) of material/cell_table.hpp. */
function applyCurve({ low, high, values }: ToneCurve, x: number): number {
  if (values.length === 0) return x;
  if (x <= low) return values[0]! + (x - low);
  if (x >= high) return values.at(-1)! + (x - high);
  const t = ((x - low) / (high - low)) * (values.length - 1);
  const j = Math.min(Math.floor(t), values.length - 2);
  return values[j]! + (t - j) * (values[j + 1]! - values[j]!);
}

/** Where a tone curve is tabulated. */
export interface Range {
  low: number;
  length: number;
}

/** Rows of each subspace in the uniform `subspaces`; see sateen.glsl. */
export const SUBSPACE_ROWS = 9;

/** @param ranges  of the tone curves of a pattern */
export function subspaceRows(
  subspaces: SubspaceDescription[], moments: TextureMoments | undefined, ranges: Range[][] | undefined,
): Vector4[] {
  const n = subspaces.length;
  const factors = moments && covarianceFactors(moments.covariance, n);
  return subspaces.flatMap(({ T, mean, tone }, k) => {
    const d = mean.length;
    const band = (b: number): number => Math.min(b, d - 1);  // grey is shown as three equal bands
    const vector = (f: (b: number) => number, w = 0): Vector4 => new Vector4(f(0), f(1), f(2), w);
    const texture = moments ? [...moments.mean.subarray(4 * k, 4 * k + 3)].map((_, b) => moments.mean[4 * k + band(b)]!) : [1, 1, 1];
    return [
      ...[0, 1, 2].map((i) => vector((b) => (i < d ? T[i * d + band(b)]! : 0))),
      vector((b) => mean[band(b)]!, tone === 'srgb' ? 1 : 0),
      vector((b) => texture[b]!),
      factors ? new Vector4(...factors.subarray(4 * k, 4 * k + 4)) : new Vector4(),
      moments ? new Vector4(...moments.shape.subarray(4 * k, 4 * k + 4)) : new Vector4(),
      vector((b) => ranges?.[k]?.[b]?.low ?? 0),
      vector((b) => 1 / (ranges?.[k]?.[b]?.length ?? 1)),
    ];
  });
}

const LUMINANCE = [0.2126390059, 0.7151686788, 0.0721923154];

/**
 * F, (n, 4), of F Fᵀ ≈ the covariance: Cholesky with the largest pivot first. Textures of one noise vary
 * together, so four columns hold nearly all; what is left is given back to the diagonal.
 */
export function covarianceFactors(covariance: Float32Array, n: number): Float32Array {
  const factors = new Float32Array(4 * n);
  const rest = Float64Array.from({ length: n }, (_, k) => covariance[k * n + k]!);
  for (let r = 0; r < Math.min(4, n); ++r) {
    const pivot = rest.indexOf(Math.max(...rest));
    const root = Math.sqrt(Math.max(0, rest[pivot]!));
    if (root === 0) break;
    for (let k = 0; k < n; ++k) {
      let c = covariance[k * n + pivot]!;
      for (let i = 0; i < r; ++i) c -= factors[4 * k + i]! * factors[4 * pivot + i]!;
      factors[4 * k + r] = c / root;
      rest[k]! -= (c / root) ** 2;
    }
  }
  for (let k = 0; k < n; ++k) {
    const held = [0, 1, 2, 3].reduce((sum, i) => sum + factors[4 * k + i]! ** 2, 0);
    const scale = held > 0 ? Math.sqrt(covariance[k * n + k]! / held) : 1;
    for (let i = 0; i < 4; ++i) factors[4 * k + i]! *= scale;
  }
  return factors;
}

/**
 * Column k, row level: the variance of each band that the level hides before the tone, and the share of the
 * luminance's that it keeps. @param hidden, all  of the planes, (subspaces, LEVELS, 3) and (subspaces, 3)
 */
export function hiddenTexture(subspaces: SubspaceDescription[], hidden: Float32Array, all: Float32Array): DataTexture {
  const n = subspaces.length;
  const data = new Uint16Array(4 * n * LEVELS);
  subspaces.forEach(({ T, mean }, k) => {
    const d = mean.length;
    const along = (i: number, b: number): number => T[i * d + Math.min(b, d - 1)]!;
    for (let m = 0; m < LEVELS; ++m) {
      const at = 4 * (m * n + k);
      let [lost, total] = [0, 0];
      for (let i = 0; i < d; ++i) {
        const grey = LUMINANCE.reduce((sum, l, b) => sum + l * along(i, b), 0) ** 2;
        lost += grey * hidden[(k * LEVELS + m) * 3 + i]!;
        total += grey * all[3 * k + i]!;
      }
      for (let b = 0; b < 3; ++b) {
        let variance = 0;
        for (let i = 0; i < d; ++i) variance += along(i, b) ** 2 * hidden[(k * LEVELS + m) * 3 + i]!;
        data[at + b] = DataUtils.toHalfFloat(variance);
      }
      data[at + 3] = DataUtils.toHalfFloat(total > 0 ? 1 - lost / total : 1);
    }
  });
  const texture = new DataTexture(data, n, LEVELS, RGBAFormat, HalfFloatType);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Texels of four words in rows of LIST_COLS. */
function listTexture(words: Uint32Array): DataTexture {
  const rows = Math.max(1, Math.ceil(words.length / 4 / LIST_COLS));
  const data = new Uint32Array(4 * rows * LIST_COLS);
  data.set(words);
  const texture = new DataTexture(data, LIST_COLS, rows, RGBAIntegerFormat, UnsignedIntType);
  texture.internalFormat = 'RGBA32UI';
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

const BITS = new Float32Array(1);
const bitsOf = (x: number): number => {
  BITS[0] = x;
  return new Uint32Array(BITS.buffer)[0]!;
};

/** What the shader needs of measured directions; of photographs, empty lists. */
export interface DirectionTextures {
  /** Cells to start from, then three texels a cell. */
  viewCells: Texture;
  /** The same, then (z, ∛z) of each light. */
  lightCells: Texture;
  /** Texel of `lightCells` where the heights begin. */
  lightHeights: number;
  /** Bits of e_0 … e_2; e of the contrast as a half, and the subspace. */
  pairs: Texture;
}

export function directionTextures(data: MaterialData): DirectionTextures {
  const { lightCells, lights, bands, appearance } = data;
  const cells = lightCells.length > 0 ? lightCells.length - 1 : 0;
  const withHeights = new Uint32Array(cells + 4 * lights.length);
  withHeights.set(lightCells.subarray(1));
  lights.forEach(([theta], i) => {
    const z = Math.cos(theta);
    withHeights.set([bitsOf(z), bitsOf(Math.cbrt(z))], cells + 4 * i);
  });
  const pairs = new Uint32Array(4 * data.subspaceOf.length);
  data.subspaceOf.forEach((k, pair) => {
    const e = (c: number): number => appearance?.[4 * pair + c] ?? 0;
    const half = DataUtils.toHalfFloat(e(bands));
    pairs.set([0, 1, 2].map((b) => bitsOf(e(Math.min(b, bands - 1)))), 4 * pair);
    pairs[4 * pair + 3] = ((half << 16) | k) >>> 0;
  });
  return {
    viewCells: listTexture(data.viewCells.subarray(1)),
    lightCells: listTexture(withHeights),
    lightHeights: cells / 4,
    pairs: listTexture(pairs),
  };
}
