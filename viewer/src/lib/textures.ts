// SPDX-License-Identifier: Apache-2.0
// A drawn material as textures for sateen.glsl.
import {
  ClampToEdgeWrapping, DataTexture, DataUtils, FloatType, HalfFloatType, LinearFilter, LinearMipmapLinearFilter,
  NearestFilter, RepeatWrapping, RGBAFormat, RGBAIntegerFormat, UnsignedIntType, Vector4, type Texture,
} from 'three';

import { type Basis, GROUP, type Levels, LEVELS } from './basis';
import type { MaterialData } from './runtime';

/** Texels a row in textures that are lists. */
export const LIST_COLS = 1024;

/** A toroidal texture with the levels as they were computed. */
function levelTexture({ rows, cols, levels }: Levels, anisotropy: number): DataTexture {
  const texture = new DataTexture(levels[0]!, cols, rows, RGBAFormat);
  texture.mipmaps = levels.map((data, m) => ({
    data, width: Math.max(1, cols >> m), height: Math.max(1, rows >> m),
  })) as never;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = anisotropy;
  texture.needsUpdate = true;
  return texture;
}

function floatTexture(data: Float32Array, cols: number, rows: number): DataTexture {
  const texture = new DataTexture(data, cols, rows, RGBAFormat, FloatType);
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Groups of components, and the cells of a pattern, under the names of sateen.glsl. */
export function basisTextures(basis: Basis, anisotropy: number): Record<string, Texture> {
  const named = (name: string, groups: Levels[], by: number): [string, Texture][] =>
    groups.map((group, j) => [`${name}${j}`, levelTexture(group, by)]);
  return Object.fromEntries([...named('basis', basis.groups, anisotropy), ...named('cells', basis.cells, 1)]);
}

/** A vector for each group. */
export function byGroup(values: Float32Array): Vector4[] {
  return Array.from({ length: values.length / GROUP }, (_, j) => new Vector4().fromArray(values, GROUP * j));
}

/** Column level: the share of the variance that it keeps of each group, and of the luminance. */
export function keptTexture({ kept, groupKept, groups }: Basis): DataTexture {
  const data = new Uint16Array(4 * LEVELS);
  for (let m = 0; m < LEVELS; ++m) {
    groups.forEach((_, j) => (data[4 * m + j] = DataUtils.toHalfFloat(groupKept[m * groups.length + j]!)));
    data[4 * m + 3] = DataUtils.toHalfFloat(kept[m]!);
  }
  const texture = new DataTexture(data, LEVELS, 1, RGBAFormat, HalfFloatType);
  texture.magFilter = texture.minFilter = LinearFilter;
  texture.wrapS = texture.wrapT = ClampToEdgeWrapping;
  texture.needsUpdate = true;
  return texture;
}

/** Row k: S B of red, green and blue of each group, then mean and shape. */
export function subspaceTexture({ coefficients, moments, groups }: Basis, bands: number): DataTexture {
  const n = groups.length;
  const cols = 3 * n + 2;
  const subspaces = moments.mean.length / 4;
  const data = new Float32Array(4 * cols * subspaces);
  for (let k = 0; k < subspaces; ++k) {
    for (let j = 0; j < n; ++j)
      for (let c = 0; c < 3; ++c)
        data.set(coefficients.subarray((k * 3 + c) * GROUP * n + GROUP * j, (k * 3 + c) * GROUP * n + GROUP * (j + 1)),
          4 * (k * cols + 3 * j + c));
    const at = 4 * (k * cols + 3 * n);
    for (let c = 0; c < 3; ++c) data[at + c] = moments.mean[4 * k + Math.min(c, bands - 1)]!;
    data.set(moments.shape.subarray(4 * k, 4 * k + 4), at + 4);
  }
  return floatTexture(data, cols, subspaces);
}

const LUMINANCE = [0.2126390059, 0.7151686788, 0.0721923154];
const HALF_BALL = 2048;

/**
 * Shares of the lights in light from everywhere: what of the half ball is nearest to each, times the cosine
 * where the values do not have it; where they do, the cosine over that of the light.
 */
export function skyShares(lights: [number, number][], cosineIncluded: boolean): Float32Array {
  const shares = new Float32Array(lights.length);
  const vectors = lights.map(([t, p]) => [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)] as const);
  for (let i = 0; i < HALF_BALL; ++i) {
    const z = (i + 0.5) / HALF_BALL;
    const [r, phi] = [Math.sqrt(1 - z * z), i * 2.399963229728653];
    const [x, y] = [r * Math.cos(phi), r * Math.sin(phi)];
    let [nearest, most] = [0, -2];
    for (let l = 0; l < vectors.length; ++l) {
      const [a, b, c] = vectors[l]!;
      const dot = a * x + b * y + c * z;
      if (dot > most) [nearest, most] = [l, dot];
    }
    // L = ∫ (value / π) (E / π) dω, over E / π.
    shares[nearest]! += (2 / HALF_BALL) * (cosineIncluded ? Math.min(1.5, z / Math.max(vectors[nearest]![2], 0.05)) : z);
  }
  return shares;
}

/** Row v: mean colour under light from everywhere; and what all pairs' textures are in means then. */
export function skyOf(data: MaterialData, basis: Basis): { texture: DataTexture; rows: Float32Array } {
  const { views, lights, subspaceOf, appearance, bands, cosineIncluded } = data;
  const { coefficients, moments, S } = basis;
  const r = S.length;
  const shares = skyShares(lights, cosineIncluded);
  const band = (c: number): number => Math.min(c, bands - 1);
  const means = (k: number): number[] => [0, 1, 2].map((c) => Math.max(1e-6, moments.mean[4 * k + band(c)]!));
  // The contrast that the luminance of each subspace has.
  const contrast = Array.from({ length: moments.mean.length / 4 }, (_, k) => {
    let variance = 0;
    for (let i = 0; i < r; ++i)
      variance += (LUMINANCE.reduce((s, l, c) => s + l * coefficients[(3 * k + c) * r + i]!, 0) / S[i]!) ** 2;
    return Math.sqrt(variance) / means(k).reduce((s, m, c) => s + LUMINANCE[c]! * m, 0);
  });
  const colours = new Float32Array(4 * views.length);
  const rows = new Float32Array(3 * r);
  const total = [0, 0, 0];
  subspaceOf.forEach((k, pair) => {
    const v = pair % views.length;
    const wanted = appearance ? Math.max(0, appearance[4 * pair + bands]!) : 0;
    const amplify = appearance && contrast[k]! > 1e-6 ? Math.min(3, wanted / contrast[k]!) : 1;
    means(k).forEach((mean, c) => {
      const value = shares[Math.floor(pair / views.length)]! *
        (appearance ? Math.max(0, appearance[4 * pair + band(c)]!) ** 3 : mean);
      colours[4 * v + c]! += value;
      total[c]! += value;
      for (let i = 0; i < r; ++i) rows[c * r + i]! += (value * amplify * coefficients[(3 * k + c) * r + i]!) / mean;
    });
  });
  for (let i = 0; i < rows.length; ++i) rows[i]! /= Math.max(total[Math.floor(i / r)]!, 1e-6);
  // By groups, as the shader reads them.
  const grouped = new Float32Array(3 * r);
  for (let i = 0; i < r; ++i)
    for (let c = 0; c < 3; ++c) grouped[3 * GROUP * Math.floor(i / GROUP) + GROUP * c + (i % GROUP)] = rows[c * r + i]!;
  return { texture: floatTexture(colours, 1, views.length), rows: grouped };
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

/** What the shader needs of measured directions; of photographs, empty lists. */
export interface DirectionTextures {
  /** Cells to start from, then three texels a cell. */
  viewCells: Texture;
  lightCells: Texture;
  /** e of three bands; bytes of a whole number: subspace, ∛z of the light, e of the contrast. */
  pairs: Texture;
}

/** @returns  the textures, and what a byte of e of the contrast is multiplied by */
export function directionTextures(data: MaterialData): { textures: DirectionTextures; contrastScale: number } {
  const { views, lights, bands, appearance } = data;
  const contrast = (pair: number): number => Math.max(0, appearance?.[4 * pair + bands] ?? 0);
  let most = 1e-6;
  data.subspaceOf.forEach((_, pair) => (most = Math.max(most, contrast(pair))));
  const rows = Math.max(1, Math.ceil(data.subspaceOf.length / LIST_COLS));
  const pairs = new Float32Array(4 * rows * LIST_COLS);
  data.subspaceOf.forEach((k, pair) => {
    for (let c = 0; c < 3; ++c) pairs[4 * pair + c] = appearance?.[4 * pair + Math.min(c, bands - 1)] ?? 0;
    const root = Math.round(255 * Math.cbrt(Math.max(0, Math.cos(lights[Math.floor(pair / views.length)]![0]))));
    pairs[4 * pair + 3] = 65536 * k + 256 * root + Math.round((255 * contrast(pair)) / most);
  });
  return {
    textures: {
      viewCells: listTexture(data.viewCells.subarray(1)),
      lightCells: listTexture(data.lightCells.subarray(1)),
      pairs: floatTexture(pairs, LIST_COLS, rows),
    },
    contrastScale: most / 255,
  };
}
