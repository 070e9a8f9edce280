// SPDX-License-Identifier: Apache-2.0
// The textures of all subspaces as sums of a few: what a pixel would read of each subspace it reads once.
//
// Textures of one noise vary together, so the K·3 bands of K subspaces have few principal components φ:
//     v_k,c(x) = mean_k,c + Σ_r B_k,c,r φ_r(x),   E φ = 0,  E φ_r φ_s = δ_rs
// A component is stored as the g of φ = S exp(a g) + O, a shifted lognormal curve with its skewness: g is
// near a Gaussian field, may be blended as one, and the curve applied after.
import type { PatternPhase } from './runtime';

/** Components are stored four a texture. */
export const GROUP = 4;
const MAX_GROUPS = 3;
/** Components are added until this of the contrast is left, root mean square over the bands. */
const LEFT = 0.02;
/** Levels of the tables; coarser ones look like the last. */
export const LEVELS = 9;
/** Texels that tell the covariance of the bands, about. */
const SAMPLES = 8192;
/** g is stored between these quantiles' neighbours, at most this many deviations. */
const REACH = 5;
/** At most this many groups have the components of so many bands, of all subspaces. */
export const mostGroups = (bands: number): number => Math.min(MAX_GROUPS, Math.ceil(bands / GROUP));

const LUMINANCE = [0.2126390059, 0.7151686788, 0.0721923154];

export interface Torus {
  rows: number;
  cols: number;
}

/** A mipmapped texture of four components, RGBA of 8 bits. */
export interface Levels extends Torus {
  levels: Uint8Array[];
}

export interface Basis extends Torus {
  /** One texture a group of four components, and the same of a pattern's cells: means by phase. */
  groups: Levels[];
  cells: Levels[];
  /** Of each component t = 0 … 1 as stored: φ = S (exp(a t) + offset). (4 groups) each */
  exponent: Float32Array;
  offset: Float32Array;
  S: Float32Array;
  /** Of each band of each subspace S_r B_r, (K, 3, 4 groups). Grey is three equal bands. */
  coefficients: Float32Array;
  /** Mean of t of each component in level 0, and where nothing of its variance is left. */
  middle: Float32Array;
  farMiddle: Float32Array;
  /** Share of each group's variance that each level keeps, (LEVELS, groups). */
  groupKept: Float32Array;
  /** Share of the luminance's variance that each level keeps. */
  kept: Float32Array;
  /** Of the textures as drawn, before components are left out. */
  moments: Moments;
  /** Root mean square of what is left out, in means of the bands. */
  left: number;
}

/** (K, 4) each, as TextureMoments of synthesis/interpolate.hpp. */
export interface Moments {
  mean: Float32Array;
  shape: Float32Array;
}

interface Bands {
  values: Float32Array[];
  mean: Float64Array;
  /** The deviation times this is what components are sought of. */
  weight: Float64Array;
}

const sum = (values: Float32Array): number => {
  let s = 0;
  for (let i = 0; i < values.length; ++i) s += values[i]!;
  return s;
};

/** Means of bands and shapes: texture_moments of synthesis/interpolate.cpp. */
export function textureMoments(textures: Float32Array[], bands: number): Moments {
  const n = textures.length;
  const sites = textures[0]!.length / bands;
  const moments = { mean: new Float32Array(4 * n), shape: new Float32Array(4 * n) };
  textures.forEach((texture, k) => {
    const planes = Array.from({ length: bands }, (_, b) => texture.subarray(b * sites, (b + 1) * sites));
    const share = bands === 3 ? LUMINANCE : [1];
    const mean = planes.map((plane) => sum(plane) / sites);
    const middle = mean.reduce((s, m, b) => s + share[b]! * m, 0);
    const Y = new Float32Array(sites);
    const roots = planes.map((plane, b) => {
      let root = 0;
      for (let i = 0; i < sites; ++i) {
        root += Math.sqrt(plane[i]!);
        Y[i]! += share[b]! * plane[i]!;
      }
      return root;
    });
    let [root, variance] = [0, 0];
    for (let i = 0; i < sites; ++i) {
      root += Math.sqrt(Y[i]!);
      variance += (Y[i]! - middle) * (Y[i]! - middle);
    }
    variance /= sites;
    const h = (of: number, s: number): number => (of > 0 && s > 0 ? -8 * Math.log(s / sites / Math.sqrt(of)) : 0);
    const C = middle > 0 ? Math.log1p(variance / (middle * middle)) : 0;
    const H = h(middle, root);
    moments.mean.set(mean, 4 * k);
    moments.shape.set([1, 1, 1, 0], 4 * k);
    if (C > 1e-5) {
      mean.forEach((m, b) => (moments.shape[4 * k + b] = h(m, roots[b]!) / H));
      moments.shape[4 * k + 3] = (H - C) / (C * C);
    }
  });
  return moments;
}

/** Deviations of every band from its mean, in means: a dark band counts as a bright one. */
function bandsOf(textures: Float32Array[], bands: number, moments: Moments): Bands {
  const sites = textures[0]!.length / bands;
  const n = textures.length * bands;
  const out = { values: [] as Float32Array[], mean: new Float64Array(n), weight: new Float64Array(n) };
  textures.forEach((texture, k) => {
    const of = (b: number): number => moments.mean[4 * k + b]!;
    const Y = bands === 3 ? LUMINANCE.reduce((s, l, b) => s + l * of(b), 0) : of(0);
    for (let b = 0; b < bands; ++b) {
      out.values.push(texture.subarray(b * sites, (b + 1) * sites));
      out.mean[k * bands + b] = of(b);
      out.weight[k * bands + b] = 1 / Math.max(1e-6, 0.75 * of(b) + 0.25 * Y);
    }
  });
  return out;
}

/** Every `step`-th texel, moved along from row to row, tells the covariance. */
function covarianceOf({ values, mean, weight }: Bands): Float64Array {
  const n = values.length;
  const step = Math.max(1, Math.floor(values[0]!.length / SAMPLES)) | 1;
  const samples = values.map((v, i) => {
    const out = new Float32Array(Math.floor(v.length / step));
    for (let s = 0; s < out.length; ++s) out[s] = (v[s * step]! - mean[i]!) * weight[i]!;
    return out;
  });
  const C = new Float64Array(n * n);
  for (let i = 0; i < n; ++i)
    for (let j = 0; j <= i; ++j) {
      const [a, b] = [samples[i]!, samples[j]!];
      let s = 0;
      for (let q = 0; q < a.length; ++q) s += a[q]! * b[q]!;
      C[i * n + j] = C[j * n + i] = s / a.length;
    }
  return C;
}

/**
 * The eigenvectors of the `count` largest eigenvalues of C, (n, n), as rows, largest first: orthogonal
 * iteration. Cost O(n² count) a round.
 */
export function principal(C: Float64Array, n: number, count: number): { vectors: Float64Array[]; values: number[] } {
  let vectors = Array.from({ length: count }, (_, r) =>
    Float64Array.from({ length: n }, (_, i) => Math.cos(1 + i * (r + 1) * 2.399963) + (i % count === r ? 1 : 0)));
  let values: number[] = [];
  for (let round = 0; round < 60; ++round) {
    vectors = vectors.map((v) => {
      const out = new Float64Array(n);
      for (let i = 0; i < n; ++i) {
        let s = 0;
        for (let j = 0; j < n; ++j) s += C[i * n + j]! * v[j]!;
        out[i] = s;
      }
      return out;
    });
    values = vectors.map((v, r) => {
      for (let twice = 0; twice < 2; ++twice)
        for (let q = 0; q < r; ++q) {
          const other = vectors[q]!;
          let s = 0;
          for (let i = 0; i < n; ++i) s += v[i]! * other[i]!;
          for (let i = 0; i < n; ++i) v[i]! -= s * other[i]!;
        }
      const length = Math.hypot(...v);
      for (let i = 0; i < n; ++i) v[i] = length > 1e-300 ? v[i]! / length : 0;
      return length;
    });
  }
  return { vectors, values };
}

/** φ of variance 1 of each component, and the deviation that was taken out of it. */
function componentsOf({ values, mean, weight }: Bands, vectors: Float64Array[]): { phi: Float32Array; deviation: number }[] {
  const sites = values[0]!.length;
  const all = vectors.map(() => new Float32Array(sites));
  // By blocks that stay in the cache.
  const BLOCK = 4096;
  for (let first = 0; first < sites; first += BLOCK) {
    const last = Math.min(sites, first + BLOCK);
    for (let i = 0; i < values.length; ++i) {
      const [v, m] = [values[i]!, mean[i]!];
      for (let r = 0; r < vectors.length; ++r) {
        const w = vectors[r]![i]! * weight[i]!;
        const phi = all[r]!;
        for (let x = first; x < last; ++x) phi[x]! += w * (v[x]! - m);
      }
    }
  }
  return all.map((phi) => {
    let squares = 0;
    for (let x = 0; x < sites; ++x) squares += phi[x]! * phi[x]!;
    const deviation = Math.sqrt(squares / sites);
    const scale = deviation > 0 ? 1 / deviation : 0;
    for (let x = 0; x < sites; ++x) phi[x]! *= scale;
    return { phi, deviation };
  });
}

/** φ = S exp(a g) + O: of mean 0, variance 1 and the skewness of the component, g of mean 0 and variance 1. */
interface Curve {
  a: number;
  S: number;
  O: number;
}

/** Lognormal of skewness s: (e^{a²} + 2) √(e^{a²} - 1) = s, by bisection; of no skewness nearly a line. */
export function curveOf(phi: Float32Array): Curve {
  let skewness = 0;
  for (let x = 0; x < phi.length; ++x) skewness += phi[x]! * phi[x]! * phi[x]!;
  skewness /= phi.length;
  let [low, high] = [0.02, 0.9];
  for (let i = 0; i < 30; ++i) {
    const a = (low + high) / 2;
    const e = Math.exp(a * a);
    if ((e + 2) * Math.sqrt(e - 1) < Math.abs(skewness)) low = a;
    else high = a;
  }
  const a = low * (skewness < 0 ? -1 : 1);
  const e = Math.exp(a * a);
  const S = Math.sign(a) / Math.sqrt(e * (e - 1));
  return { a, S, O: -S * Math.sqrt(e) };
}

/** Half the rows and columns; what is beyond an even number of them is left out. */
function halved(plane: Float32Array, rows: number, cols: number): Float32Array {
  const [r2, c2] = [Math.max(1, rows >> 1), Math.max(1, cols >> 1)];
  const [down, right] = [rows > 1 ? cols : 0, cols > 1 ? 1 : 0];
  const out = new Float32Array(r2 * c2);
  for (let r = 0; r < r2; ++r)
    for (let c = 0; c < c2; ++c) {
      const i = 2 * r * cols * (rows > 1 ? 1 : 0) + 2 * c * right;
      out[r * c2 + c] = (plane[i]! + plane[i + right]! + plane[i + down]! + plane[i + down + right]!) / 4;
    }
  return out;
}

/** t = slope ln((φ - from) scale) + start. */
interface Code {
  slope: number;
  start: number;
  from: number;
  scale: number;
  least: number;
}

/** Each level is the curve's inverse of the mean of φ: a distant texture fades to its true mean. */
function storeLevels(
  plane: Float32Array, { rows, cols }: Torus, { slope, start, scale, least, from }: Code, into: Levels, channel: number,
  each?: (level: number, plane: Float32Array, middle: number) => void,
): void {
  for (let m = 0; ; ++m) {
    const texels = (into.levels[m] ??= new Uint8Array(4 * rows * cols));
    let total = 0;
    for (let i = 0, at = channel; i < plane.length; ++i, at += 4) {
      const x = (plane[i]! - from) * scale;
      const t = slope * Math.log(x > least ? x : least) + start;
      const byte = t < 0 ? 0 : t > 1 ? 255 : Math.floor(255 * t + 0.5);
      texels[at] = byte;
      total += byte;
    }
    each?.(m, plane, total / plane.length / 255);
    if (rows === 1 && cols === 1) return;
    plane = halved(plane, rows, cols);
    [rows, cols] = [Math.max(1, rows >> 1), Math.max(1, cols >> 1)];
  }
}

/** Means of φ by phase of the pattern, on a torus of whole phases. */
function cellMeans(phi: Float32Array, bin: Int32Array, { rows, cols }: Torus): Float32Array {
  const total = new Float32Array(rows * cols);
  const count = new Float32Array(rows * cols);
  for (let x = 0; x < phi.length; ++x) {
    total[bin[x]!]! += phi[x]!;
    ++count[bin[x]!]!;
  }
  // Where nothing fell, the mean of what is around.
  for (let empty = true; empty;) {
    empty = false;
    const before = count.slice();
    for (let i = 0; i < total.length; ++i) {
      if (before[i]! > 0) continue;
      const [r, c] = [Math.floor(i / cols), i % cols];
      for (const j of [((r + 1) % rows) * cols + c, ((r + rows - 1) % rows) * cols + c, r * cols + ((c + 1) % cols), r * cols + ((c + cols - 1) % cols)])
        if (before[j]! > 0) {
          total[i]! += total[j]! / before[j]!;
          ++count[i]!;
        }
      empty ||= count[i] === 0;
    }
    if (count.every((n) => n === 0)) break;
  }
  return total.map((t, i) => t / Math.max(1, count[i]!));
}

/** The phase of every texel as the number of a bin. */
function phaseBins({ shift, inverse }: PatternPhase, torus: Torus, cell: Torus): Int32Array {
  const sites = torus.rows * torus.cols;
  const turn = (u: number, n: number): number => Math.min(n - 1, Math.floor((u - Math.floor(u)) * n));
  return Int32Array.from({ length: sites }, (_, x) => {
    const [r, c] = [Math.floor(x / torus.cols), x % torus.cols];
    const u = inverse[0]! * r + inverse[1]! * c + shift[x]!;
    const v = inverse[2]! * r + inverse[3]! * c + shift[sites + x]!;
    return turn(u, cell.rows) * cell.cols + turn(v, cell.cols);
  });
}

/**
 * @param textures  of every subspace, (bands, rows, cols), linear
 * @param pattern   its phase on the same torus, and samples of a cell
 */
export function makeBasis(
  textures: Float32Array[], bands: number, torus: Torus, pattern?: { phase: PatternPhase; cell: Torus },
): Basis {
  const moments = textureMoments(textures, bands);
  const all = bandsOf(textures, bands, moments);
  const n = all.values.length;
  const C = covarianceOf(all);
  const { vectors, values } = principal(C, n, Math.min(n, GROUP * MAX_GROUPS));
  const total = Array.from({ length: n }, (_, i) => C[i * n + i]!).reduce((s, x) => s + x, 0);
  let left = total;
  let count = 0;
  while (count < vectors.length && left > n * LEFT * LEFT) left -= values[count++]!;
  const groups = Math.max(1, Math.ceil(count / GROUP));
  count = Math.min(vectors.length, groups * GROUP);
  left = Math.max(0, total - values.slice(0, count).reduce((s, x) => s + x, 0));

  const { rows, cols } = torus;
  const cell = pattern?.cell ?? { rows: 0, cols: 0 };
  const basis: Basis = {
    rows, cols, moments,
    groups: Array.from({ length: groups }, () => ({ rows, cols, levels: [] })),
    cells: pattern ? Array.from({ length: groups }, () => ({ ...cell, levels: [] })) : [],
    exponent: new Float32Array(groups * GROUP),
    offset: new Float32Array(groups * GROUP),
    S: new Float32Array(groups * GROUP).fill(1),
    coefficients: new Float32Array(textures.length * 3 * groups * GROUP),
    middle: new Float32Array(groups * GROUP),
    farMiddle: new Float32Array(groups * GROUP),
    groupKept: new Float32Array(LEVELS * groups),
    kept: new Float32Array(LEVELS),
    left: Math.sqrt(left / n),
  };
  const bins = pattern && phaseBins(pattern.phase, torus, cell);
  const components = componentsOf(all, vectors.slice(0, count));
  let weights = 0;
  for (let r = 0; r < count; ++r) {
    const { phi, deviation } = components[r]!;
    const { a, S, O } = curveOf(phi);
    const least = Math.exp(-REACH * Math.abs(a));
    const inverse = (x: number): number => Math.log(Math.max(least, (x - O) / S)) / a;
    let [low, high] = [Infinity, -Infinity];
    for (let x = 0; x < phi.length; x += 7) {
      const g = inverse(phi[x]!);
      if (g < low) low = g;
      if (g > high) high = g;
    }
    [low, high] = [Math.max(-REACH, low - 0.3), Math.min(REACH, high + 0.3)];
    if (!(high > low)) [low, high] = [-1, 1];
    const code = { slope: 1 / (a * (high - low)), start: -low / (high - low), from: O, scale: 1 / S, least };
    const group = Math.floor(r / GROUP);
    storeLevels(phi, torus, code, basis.groups[group]!, r % GROUP, (m, plane, middle) => {
      if (m >= LEVELS) return;
      let squares = 0;
      for (let i = 0; i < plane.length; ++i) squares += plane[i]! * plane[i]!;
      if (m === 0) basis.middle[r] = middle;
      const energy = (values[r]! * squares) / plane.length;
      basis.groupKept[m * groups + group]! += energy;
      basis.kept[m]! += energy;
    });
    // t of φ = 0.
    basis.farMiddle[r] = Math.min(1, Math.max(0, code.slope * Math.log(Math.max(least, -O / S)) + code.start));
    if (bins) storeLevels(cellMeans(phi, bins, cell), cell, code, basis.cells[group]!, r % GROUP);
    weights += values[r]!;
    const scale = S * Math.exp(a * low);
    basis.exponent[r] = a * (high - low);
    basis.offset[r] = O / scale;
    basis.S[r] = scale;
    for (let k = 0; k < textures.length; ++k)
      for (let c = 0; c < 3; ++c) {
        const i = k * bands + Math.min(c, bands - 1);
        basis.coefficients[(k * 3 + c) * groups * GROUP + r] = ((vectors[r]![i]! * deviation) / all.weight[i]!) * scale;
      }
  }
  for (let m = LEVELS - 1; m >= 0; --m) {
    basis.kept[m] = weights > 0 ? Math.min(1, basis.kept[m]! / weights) : 1;
    for (let j = 0; j < groups; ++j) {
      const all = basis.groupKept[j]!;
      basis.groupKept[m * groups + j] = all > 0 ? Math.min(1, basis.groupKept[m * groups + j]! / all) : 1;
    }
  }
  return basis;
}
