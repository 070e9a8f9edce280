// SPDX-License-Identifier: Apache-2.0
// A drawn material as textures for sateen.glsl.
import {
  ClampToEdgeWrapping, DataArrayTexture, DataTexture, DataUtils, FloatType, HalfFloatType, LinearFilter,
  LinearMipmapLinearFilter, NearestFilter, RepeatWrapping, RGBAFormat, RGBAIntegerFormat, UnsignedByteType,
  UnsignedIntType, type Texture,
} from 'three';

import { completeIndex, toVector } from './directions';
import { type MaterialData, START_SIDE, type SubspaceDescription } from './runtime';

/** Levels of the curves; coarser fields look like the last one. */
export const LEVELS = 8;
/** Texels a row in textures that are lists. */
export const LIST_COLS = 1024;
/** Fields are stored from -G to G, curves in nodes 0.1 apart: both as in sateen.glsl. */
const G = 4.2;
const G_NODES = 85;

/** The fields of every subspace, toroidal, and how much of their variance each mip level keeps. */
export class FieldTexture {
  readonly texture: DataArrayTexture;
  /** (subspaces, LEVELS, 3) */
  readonly variance: Float32Array;
  /** (subspaces, 3): mean linear reflectance of each texture. */
  readonly mean: Float32Array;
  private readonly data: Uint8Array;

  constructor(readonly side: number, private readonly bands: number, subspaces: number) {
    this.data = new Uint8Array(4 * side * side * subspaces);
    this.variance = new Float32Array(subspaces * LEVELS * 3).fill(1);
    this.mean = new Float32Array(subspaces * 3);
    this.texture = new DataArrayTexture(this.data, side, side, subspaces);
    this.texture.format = RGBAFormat;
    this.texture.type = UnsignedByteType;
    this.texture.wrapS = this.texture.wrapT = RepeatWrapping;
    this.texture.magFilter = LinearFilter;
    this.texture.minFilter = LinearMipmapLinearFilter;
    this.texture.generateMipmaps = true;
    this.texture.anisotropy = 8;
  }

  /** Takes the fields of one subspace, (bands, side, side). */
  set(subspace: number, fields: Float32Array, description: SubspaceDescription): void {
    this.mean.set(meanColour(fields, this.side * this.side, description), 3 * subspace);
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

  /** Takes a finished texture of linear reflectance, for materials that are not fields alone. */
  setColour(subspace: number, colour: Float32Array): void {
    const sites = this.side * this.side;
    const at = 4 * sites * subspace;
    for (let band = 0; band < 3; ++band) {
      const values = colour.subarray(Math.min(band, this.bands - 1) * sites).subarray(0, sites);
      this.mean[3 * subspace + band] = values.reduce((sum, v) => sum + v, 0) / sites;
      const plane = colour.subarray(Math.min(band, this.bands - 1) * sites);
      for (let i = 0; i < sites; ++i) this.data[at + 4 * i + band] = Math.round(255 * Math.sqrt(clamp(plane[i]! / 2, 0, 1)));
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

/** Mean linear colour of what fields become, from every 7th site: invert_spectral. */
function meanColour(fields: Float32Array, sites: number, { T, mean, tone, scale, knots }: SubspaceDescription): number[] {
  const d = mean.length;
  const sum = [0, 0, 0];
  let count = 0;
  for (let i = 0; i < sites; i += 7, ++count) {
    const q = scale.map((s, plane) => marginal(s, knots[plane]!, fields[plane * sites + i]!));
    for (let band = 0; band < 3; ++band) {
      const b = Math.min(band, d - 1);
      let v = mean[b]!;
      for (let plane = 0; plane < d; ++plane) v += T[plane * d + b]! * q[plane]!;
      v = Math.max(0, v);
      sum[band]! += tone === 'linear' ? v : v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
    }
  }
  return sum.map((s) => s / count);
}

// Nodes and weights of the expectation over a standard normal value: a fine midpoint rule.
const NORMAL = Array.from({ length: 33 }, (_, i) => {
  const z = (i - 16) * 0.25;
  return [z, 0.25 * Math.exp(-z * z / 2) / Math.sqrt(2 * Math.PI)] as const;
});

/**
 * Rows (subspace, level) of q(g) in the nodes of g, one plane a channel. A level that keeps the
 * share σ² of the variance has E[q(g + √(1 - σ²) z)] for z ~ N(0, 1).
 */
export function curveTexture(subspaces: SubspaceDescription[], variance: Float32Array): DataTexture {
  const data = new Uint16Array(4 * G_NODES * subspaces.length * LEVELS);
  subspaces.forEach((subspace, k) => {
    for (let m = 0; m < LEVELS; ++m)
      for (let band = 0; band < subspace.mean.length; ++band) {
        const hidden = Math.sqrt(1 - variance[(k * LEVELS + m) * 3 + band]!);
        const [scale, knots] = [subspace.scale[band]!, subspace.knots[band]!];
        for (let n = 0; n < G_NODES; ++n) {
          const g = -G + 0.1 * n;
          let q = 0;
          if (hidden < 1e-3) q = marginal(scale, knots, g);
          else for (const [z, w] of NORMAL) q += w * marginal(scale, knots, g + hidden * z);
          data[4 * ((k * LEVELS + m) * G_NODES + n) + band] = DataUtils.toHalfFloat(q);
        }
      }
  });
  const texture = new DataTexture(data, G_NODES, subspaces.length * LEVELS, RGBAFormat, HalfFloatType);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

/** Column k: rows of T, mean and tone, and the variance of each band that each level hides. */
export function planeTexture(subspaces: SubspaceDescription[], variance: Float32Array): DataTexture {
  const n = subspaces.length;
  const data = new Float32Array(4 * n * (4 + LEVELS));
  subspaces.forEach(({ T, mean, tone, scale }, k) => {
    const d = mean.length;
    const put = (row: number, band: number, value: number): void => {
      data[4 * (row * n + k) + band] = value;
    };
    for (let band = 0; band < 3; ++band) {
      const b = Math.min(band, d - 1);  // grey is shown as three equal bands
      put(3, band, mean[b]!);
      for (let i = 0; i < d; ++i) put(i, band, T[i * d + b]!);
      for (let m = 0; m < LEVELS; ++m) {
        let hidden = 0;
        for (let i = 0; i < d; ++i)
          hidden += (T[i * d + b]! * scale[i]!) ** 2 * (1 - variance[(k * LEVELS + m) * 3 + i]!);
        put(4 + m, band, hidden);
      }
    }
    put(3, 3, tone === 'srgb' ? 1 : 0);
  });
  return floatList(data, n, 4 + LEVELS);
}

function floatList(data: Float32Array, cols: number, rows: number): DataTexture {
  const texture = new DataTexture(data, cols, rows, RGBAFormat, FloatType);
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Texels in rows of LIST_COLS. */
function listTexture(texels: ArrayLike<number>[]): DataTexture {
  const rows = Math.max(1, Math.ceil(texels.length / LIST_COLS));
  const data = new Float32Array(4 * rows * LIST_COLS);
  texels.forEach((texel, i) => data.set(texel, 4 * i));
  return floatList(data, LIST_COLS, rows);
}

/** The map of cells to start from, and the cells, three texels each: sateen.glsl, corners_of. */
function cellTexture(packed: Uint32Array): DataTexture {
  const starts = START_SIDE * START_SIDE;
  const words = packed.subarray(1 + starts);
  const cols = LIST_COLS;
  const texels = starts / 4 + words.length / 4;
  const rows = Math.max(1, Math.ceil(texels / cols));
  const data = new Uint32Array(4 * cols * rows);
  data.set(packed.subarray(1, 1 + starts));
  data.set(words, starts);
  const texture = new DataTexture(data, cols, rows, RGBAIntegerFormat, UnsignedIntType);
  texture.internalFormat = 'RGBA32UI';
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

/** What the shader needs of measured directions; of photographs, empty lists. */
export interface DirectionTextures {
  viewCells: Texture;
  lightCells: Texture;
  pairs: Texture;
  /** cos θ of the lowest light: nothing was measured below. */
  lowestLight: number;
}

/**
 * a_ij: what makes the mean of the subspace's texture that of the pair, (max(0, e_c))³ of
 * material/reflectance.hpp. 1 where the material has no reflectance.
 */
function reflectanceOf(data: MaterialData, pair: number, mean: ArrayLike<number>, k: number): number[] {
  const LARGEST = 16;
  return [0, 1, 2].map((band) => {
    if (!data.appearance) return 1;
    const e = data.appearance[4 * pair + Math.min(band, data.bands - 1)]!;
    return clamp(Math.max(0, e) ** 3 / Math.max(1e-6, mean[3 * k + band]!), 0, LARGEST);
  });
}

/** @param mean  of the textures, (subspaces, 3) */
export function directionTextures(data: MaterialData, mean: ArrayLike<number>): DirectionTextures {
  const views = data.views.map(toVector);
  const lights = data.lights.map(toVector);
  const index = completeIndex(data.index, views, lights);
  return {
    viewCells: cellTexture(data.viewCells),
    lightCells: cellTexture(data.lightCells),
    pairs: listTexture(Array.from(index, (k, pair) => [...reflectanceOf(data, pair, mean, k), k])),
    lowestLight: lights.reduce((least, d) => Math.min(least, d[2]), 1),
  };
}

/** Slopes p = ∂z/∂x, q = ∂z/∂y (y up), height and p² + q² of a toroidal range map in pixels. */
export function surfaceTexture(heights: Float32Array, rows: number, cols: number): DataTexture {
  const data = new Uint16Array(4 * rows * cols);
  const half = DataUtils.toHalfFloat;
  for (let r = 0; r < rows; ++r)
    for (let c = 0; c < cols; ++c) {
      const z = (dr: number, dc: number): number =>
        heights[((r + dr + rows) % rows) * cols + ((c + dc + cols) % cols)]!;
      const [p, q] = [(z(0, 1) - z(0, -1)) / 2, (z(-1, 0) - z(1, 0)) / 2];
      data.set([half(p), half(q), half(z(0, 0)), half(p * p + q * q)], 4 * (r * cols + c));
    }
  const texture = new DataTexture(data, cols, rows, RGBAFormat, HalfFloatType);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = 4;
  texture.needsUpdate = true;
  return texture;
}
