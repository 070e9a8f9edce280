// SPDX-License-Identifier: Apache-2.0
// The range map as textures for sateen.glsl: synthesis/evaluate_relief.cpp.
import {
  DataTexture, DataUtils, HalfFloatType, LinearFilter, LinearMipmapLinearFilter, LinearMipmapNearestFilter,
  type MinificationTextureFilter, RepeatWrapping, RGBAFormat,
} from 'three';

/** Nodes along the map of lights, (x, y) / (1 + z) from -1 to 1: Evaluator::kMomentSide. */
export const MOMENT_SIDE = 33;
/** A few thousand normals tell the moments to a percent. */
const NORMALS = 4096;

/** A toroidal range map with its normals. */
export class ReliefTextures {
  /** N and height, (rows, cols). */
  readonly surface: DataTexture;
  /** The same for a search along a ray. */
  readonly heights: DataTexture;
  /** E t of t = max(0, N·l) + a E max(0, N·l), C_t, h_t over the surface: shading_moments() of sateen.glsl. */
  readonly moments: DataTexture;
  readonly range: [number, number] = [Infinity, -Infinity];
  private readonly normals: Float32Array;

  /** @param ambient  a: light from elsewhere over that of the lamp */
  constructor(heights: Float32Array, readonly rows: number, readonly cols: number, readonly ambient: number) {
    const data = new Uint8Array(4 * rows * cols);
    for (const z of heights) {
      if (z < this.range[0]) this.range[0] = z;
      if (z > this.range[1]) this.range[1] = z;
    }
    const scale = 255 / Math.max(this.range[1] - this.range[0], 1e-6);
    const every = Math.max(1, Math.floor((rows * cols) / NORMALS));
    const sampled: number[] = [];
    for (let r = 0; r < rows; ++r) {
      const [up, down] = [((r + rows - 1) % rows) * cols, ((r + 1) % rows) * cols];
      for (let c = 0; c < cols; ++c) {
        const i = r * cols + c;
        const z = heights[i]!;
        // y points up, against the rows.
        const p = (heights[r * cols + ((c + 1) % cols)]! - heights[r * cols + ((c + cols - 1) % cols)]!) / 2;
        const q = (heights[up + c]! - heights[down + c]!) / 2;
        const unit = 1 / Math.sqrt(1 + p * p + q * q);
        // 127 is 0, so that a flat surface has its normal upright.
        data[4 * i] = 127.5 - 127 * p * unit;
        data[4 * i + 1] = 127.5 - 127 * q * unit;
        data[4 * i + 2] = 127.5 + 127 * unit;
        data[4 * i + 3] = (z - this.range[0]) * scale + 0.5;
        if (i % every === 0) sampled.push(-p * unit, -q * unit, unit);
      }
    }
    this.normals = Float32Array.from(sampled);
    this.surface = finish(new DataTexture(data, cols, rows, RGBAFormat));
    this.heights = finish(new DataTexture(data, cols, rows, RGBAFormat), LinearMipmapNearestFilter);
    this.moments = new DataTexture(
      new Uint16Array(4 * MOMENT_SIDE * MOMENT_SIDE), MOMENT_SIDE, MOMENT_SIDE, RGBAFormat, HalfFloatType);
    this.moments.magFilter = this.moments.minFilter = LinearFilter;
    this.tabulate(1);
  }

  /** Evaluator::tabulate_shading for heights times `scale`. */
  tabulate(scale: number): void {
    const texels = this.moments.image.data as unknown as Uint16Array;
    const n = this.normals.slice();
    for (let i = 0; i < n.length; i += 3) {
      const length = Math.hypot(scale * n[i]!, scale * n[i + 1]!, n[i + 2]!);
      n.set([(scale * n[i]!) / length, (scale * n[i + 1]!) / length, n[i + 2]! / length], i);
    }
    const shading = new Float64Array(n.length / 3);
    const middle = (MOMENT_SIDE - 1) / 2;
    for (let row = 0; row < MOMENT_SIDE; ++row)
      for (let col = 0; col < MOMENT_SIDE; ++col) {
        let [x, y] = [col / middle - 1, row / middle - 1];
        // Past the horizon, where the table is read only to interpolate: the horizon.
        const out = Math.max(1, Math.hypot(x, y));
        [x, y] = [x / out, y / out];
        const s = x * x + y * y;
        const [lx, ly, lz] = [(2 * x) / (1 + s), (2 * y) / (1 + s), (1 - s) / (1 + s)];
        const count = n.length / 3;
        let lamp = 0;
        for (let i = 0; i < count; ++i) {
          shading[i] = Math.max(0, n[3 * i]! * lx + n[3 * i + 1]! * ly + n[3 * i + 2]! * lz);
          lamp += shading[i]! / count;
        }
        let [squares, roots] = [0, 0];
        for (const d of shading) {
          const t = d + this.ambient * lamp;
          squares += t * t;
          roots += Math.sqrt(t);
        }
        const at = 4 * (row * MOMENT_SIDE + col);
        const mean = Math.max(lamp * (1 + this.ambient), 1e-4);
        texels[at] = DataUtils.toHalfFloat(mean);
        texels[at + 1] = DataUtils.toHalfFloat(Math.log(Math.max(1, squares / count / (mean * mean))));
        texels[at + 2] = DataUtils.toHalfFloat(Math.max(0, -8 * Math.log(Math.max(roots / count, 1e-4) / Math.sqrt(mean))));
      }
    this.moments.needsUpdate = true;
  }

  dispose(): void {
    for (const texture of [this.surface, this.heights, this.moments]) texture.dispose();
  }
}

function finish(texture: DataTexture, filter: MinificationTextureFilter = LinearMipmapLinearFilter): DataTexture {
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = filter;
  texture.generateMipmaps = true;
  texture.needsUpdate = true;
  return texture;
}
