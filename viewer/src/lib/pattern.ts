// SPDX-License-Identifier: Apache-2.0
// The pattern of a material: its lattice on a torus, and its displacement as a texture.
import { DataTexture, DataUtils, HalfFloatType, LinearFilter, LinearMipmapLinearFilter, RepeatWrapping, RGBAFormat } from 'three';

import type { PatternPhase } from './runtime';

/**
 * B' B⁻¹ by rows, of (column, row): the lattice B' that closes on a torus is taken back to the pattern's own, B.
 * @param own, closed  B⁻¹ and B'⁻¹ by rows, (row, column) to phases
 */
export function warpOf([a, b, c, d]: number[], closed: number[]): number[] {
  const [e, f, g, h] = closed;
  const det = e! * h! - f! * g!;
  const [rr, rc] = [(h! * a! - f! * c!) / det, (h! * b! - f! * d!) / det];
  const [cr, cc] = [(e! * c! - g! * a!) / det, (e! * d! - g! * b!) / det];
  return [cc, cr, rc, rr];
}

/** Phases to (s, t) of the torus: B' by rows, columns first, from its inverse. */
export function latticeOf([a, b, c, d]: number[], { rows, cols }: { rows: number; cols: number }): number[] {
  const det = a! * d! - b! * c!;
  return [-c! / det / cols, a! / det / cols, d! / det / rows, -b! / det / rows];
}

/** Both components of B'⁻¹ D on its torus. */
export function phaseTexture({ shift }: PatternPhase, rows: number, cols: number): DataTexture {
  const sites = rows * cols;
  const texels = new Uint16Array(4 * sites);
  for (let i = 0; i < sites; ++i) {
    texels[4 * i] = DataUtils.toHalfFloat(shift[i]!);
    texels[4 * i + 1] = DataUtils.toHalfFloat(shift[sites + i]!);
  }
  const texture = new DataTexture(texels, cols, rows, RGBAFormat, HalfFloatType);
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
