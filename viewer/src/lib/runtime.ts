// SPDX-License-Identifier: Apache-2.0
// The WebAssembly runtime with types: bindings/wasm/sateen_wasm.cpp, one method a function.

/** Numbers of a sample of a cell: m of three planes, s, then l of planes 1 from 0, 2 from 0, 2 from 1. */
export const CELL_VALUES = 9;

/** One subspace, as bindings/wasm/describe.hpp writes it. */
export interface SubspaceDescription {
  members: number;
  view: number;
  light: number;
  tone: 'srgb' | 'linear';
  /** (d) */
  mean: number[];
  /** (d, d) row-major; rows are the unit eigenvectors. */
  T: number[];
  /** Standard deviation of each plane. */
  scale: number[];
  /** Of each plane 16 values in units of scale, at g = -3 … 3; or none. */
  knots: number[][];
  /** Of a pattern: the curve of each plane. */
  curves: ToneCurve[];
}

/** Linear between equally spaced abscissae, of slope 1 outside; without values the identity. */
export interface ToneCurve {
  low: number;
  high: number;
  values: number[];
}

/** What a renderer must know of a material besides its textures. */
export interface Description {
  name: string;
  source: string;
  bands: 1 | 3;
  sampleRows: number;
  sampleCols: number;
  pixelsPerMm: number | null;
  cosineIncluded: boolean;
  /** [theta, phi] in radians; empty for photographs, as are lights and index. */
  views: [number, number][];
  lights: [number, number][];
  /** Subspace of each pair, lights outermost; -1 where none was measured. */
  index: number[];
  subspaces: SubspaceDescription[];
  /** Its table of cells, and B⁻¹ by rows: (row, column) in pixels to phases. */
  pattern: { rows: number; cols: number; inverse: number[] } | null;
  /** A tile of the range map. */
  surface: { rows: number; cols: number; delit: boolean; ambient: number } | null;
}

/** A description with what a shader interpolates by. */
export interface MaterialData extends Description {
  /** Triangulated directions: packed_cells() of bindings/wasm/describe.hpp. */
  viewCells: Uint32Array;
  lightCells: Uint32Array;
  /** Subspace of every pair, lights outermost, measured or not. */
  subspaceOf: Uint8Array;
  /** e of every pair, (lights, views, 4): material/reflectance.hpp. */
  appearance: Float32Array | null;
}

/** Squares along the map of cells to start from. */
export const START_SIDE = 64;

/** Of the textures of all subspaces, from the same noise: synthesis/interpolate.hpp. */
export interface TextureMoments {
  /** (subspaces, 4): red, green, blue, 0 */
  mean: Float32Array;
  /** Of the luminances of every two, (subspaces, subspaces). */
  covariance: Float32Array;
  /** How each is distributed, (subspaces, 4). */
  shape: Float32Array;
}

/** The pattern's displacement on a torus. */
export interface PatternPhase {
  /** B'⁻¹ D, (2, rows, cols) */
  shift: Float32Array;
  /** B'⁻¹ by rows, of the lattice that closes on the torus. */
  inverse: number[];
}

/** What to draw: a torus of every subspace. */
export interface DrawOptions {
  rows: number;
  cols: number;
  seed?: bigint;
  /** Standard normal fields instead of linear reflectance. */
  fieldsOnly?: boolean;
  /** All where left out. */
  subspaces?: number[];
}

/** Takes one texture, (bands, rows, cols), a copy of its own; false stops the drawing. */
export type TakeTexture = (subspace: number, texture: Float32Array) => boolean | void;

interface Exports {
  memory: WebAssembly.Memory;
  _initialize?: () => void;
  sateen_allocate(bytes: number): number;
  sateen_release(memory: number): void;
  sateen_last_error(): number;
  sateen_load(payload: number, bytes: number): number;
  sateen_unload(loaded: number): void;
  sateen_describe(loaded: number): number;
  sateen_cells(loaded: number, lights: number): number;
  sateen_appearance(loaded: number): number;
  sateen_index(loaded: number): number;
  sateen_pattern(loaded: number, subspace: number): number;
  sateen_moments(loaded: number, rows: number, cols: number, seedLow: number, seedHigh: number): number;
  sateen_draw_phase(loaded: number, rows: number, cols: number, seedLow: number, seedHigh: number): number;
  sateen_draw_range(loaded: number, rows: number, cols: number, seedLow: number, seedHigh: number): number;
  sateen_nearest_subspace(
    loaded: number, viewTheta: number, viewPhi: number, lightTheta: number, lightPhi: number): number;
  sateen_draw(
    loaded: number, subspaces: number, count: number, rows: number, cols: number,
    seedLow: number, seedHigh: number, fieldsOnly: number): number;
}

/** A failure of the runtime, with its message for the user. */
export class SateenError extends Error {
  override name = 'SateenError';
}

/** JavaScript gives a module no whole 64 bits. */
function halves(seed: bigint): [number, number] {
  return [Number(seed & 0xffffffffn), Number((seed >> 32n) & 0xffffffffn)];
}

export class Runtime {
  private take: TakeTexture = () => false;
  private textureLength = 0;

  private constructor(private readonly exports: Exports) {}

  static async create(module: WebAssembly.Module): Promise<Runtime> {
    let runtime: Runtime | undefined;
    const instance = await WebAssembly.instantiate(module, {
      sateen: {
        take: (subspace: number, texture: number): number => runtime!.taken(subspace, texture),
      },
      env: { emscripten_notify_memory_growth: (): void => {} },
      // The standard library can print and exit; the runtime does neither.
      wasi_snapshot_preview1: new Proxy({}, { get: () => (): number => 8 /* EBADF */ }),
    });
    runtime = new Runtime(instance.exports as unknown as Exports);
    runtime.exports._initialize?.();
    return runtime;
  }

  /** A material from an unpacked payload. Unload it when done. */
  load(payload: Uint8Array): LoadedMaterial {
    const at = this.exports.sateen_allocate(Math.max(1, payload.length));
    if (at === 0) throw new SateenError('not enough memory to read the material');
    new Uint8Array(this.exports.memory.buffer, at, payload.length).set(payload);
    const handle = this.exports.sateen_load(at, payload.length);
    this.exports.sateen_release(at);
    if (handle === 0) throw this.failure();
    const description = JSON.parse(this.text(this.exports.sateen_describe(handle))) as Description;
    const pairs = description.views.length * description.lights.length;
    const table = this.exports.sateen_appearance(handle);
    const index = this.exports.sateen_index(handle);
    return new LoadedMaterial(this, handle, {
      ...description,
      viewCells: this.cells(handle, 0, description.views.length),
      lightCells: this.cells(handle, 1, description.lights.length),
      subspaceOf: index === 0 ? new Uint8Array() : new Uint8Array(this.exports.memory.buffer, index, pairs).slice(),
      appearance: table === 0 ? null : this.floats(table, 4 * pairs),
    });
  }

  /** A copy: the module's memory moves when it grows. */
  private floats(at: number, count: number): Float32Array {
    return new Float32Array(this.exports.memory.buffer, at, count).slice();
  }

  private cells(handle: number, which: number, directions: number): Uint32Array {
    if (directions === 0) return new Uint32Array();
    const at = this.exports.sateen_cells(handle, which);
    if (at === 0) throw new SateenError('directions that cannot be triangulated');
    const { buffer } = this.exports.memory;
    const count = new Uint32Array(buffer, at, 1)[0]!;
    return new Uint32Array(buffer, at, 1 + START_SIDE * START_SIDE + 12 * count).slice();
  }

  /** @internal */
  drawRange(handle: number, rows: number, cols: number, seed: bigint): Float32Array {
    return this.drawOne(rows * cols, () => this.exports.sateen_draw_range(handle, rows, cols, ...halves(seed)));
  }

  /** @internal */
  drawPhase(handle: number, rows: number, cols: number, seed: bigint): PatternPhase {
    const all = this.drawOne(2 * rows * cols + 4,
      () => this.exports.sateen_draw_phase(handle, rows, cols, ...halves(seed)));
    return { shift: all.slice(0, 2 * rows * cols), inverse: [...all.subarray(2 * rows * cols)] };
  }

  private drawOne(length: number, draw: () => number): Float32Array {
    let drawn: Float32Array = new Float32Array();
    this.take = (_, texture) => {
      drawn = texture;
    };
    this.textureLength = length;
    if (!draw()) throw this.failure();
    return drawn;
  }

  /** @internal */
  moments(handle: number, subspaces: number, rows: number, cols: number, seed: bigint): TextureMoments {
    const at = this.exports.sateen_moments(handle, rows, cols, ...halves(seed));
    if (at === 0) throw this.failure();
    const all = this.floats(at, subspaces * (8 + subspaces));
    return {
      mean: all.slice(0, 4 * subspaces),
      shape: all.slice(4 * subspaces, 8 * subspaces),
      covariance: all.slice(8 * subspaces),
    };
  }

  /** @internal */
  pattern(handle: number, subspace: number, sites: number): Float32Array {
    const at = this.exports.sateen_pattern(handle, subspace);
    if (at === 0) throw new SateenError(`no pattern of subspace ${subspace}`);
    return this.floats(at, CELL_VALUES * sites);
  }

  /** @internal */
  unload(handle: number): void {
    this.exports.sateen_unload(handle);
  }

  /** @internal */
  nearest(handle: number, view: [number, number], light: [number, number]): number {
    return this.exports.sateen_nearest_subspace(handle, ...view, ...light);
  }

  /** @internal */
  draw(handle: number, bands: number, options: DrawOptions, take: TakeTexture): void {
    const { rows, cols, seed = 0n, fieldsOnly = false, subspaces } = options;
    this.take = take;
    this.textureLength = bands * rows * cols;
    let list = 0;
    if (subspaces) {
      list = this.exports.sateen_allocate(Math.max(4, 4 * subspaces.length));
      new Uint32Array(this.exports.memory.buffer, list, subspaces.length).set(subspaces);
    }
    const drawn = this.exports.sateen_draw(
      handle, list, subspaces?.length ?? 0, rows, cols, ...halves(seed), fieldsOnly ? 1 : 0);
    if (list !== 0) this.exports.sateen_release(list);
    if (!drawn) throw this.failure();
  }

  private taken(subspace: number, texture: number): number {
    return this.take(subspace, this.floats(texture, this.textureLength)) === false ? 0 : 1;
  }

  private failure(): SateenError {
    return new SateenError(this.text(this.exports.sateen_last_error()));
  }

  private text(at: number): string {
    const bytes = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(bytes.subarray(at, bytes.indexOf(0, at)));
  }
}

export class LoadedMaterial {
  constructor(
    private readonly runtime: Runtime,
    private readonly handle: number,
    readonly description: MaterialData,
  ) {}

  /** Heights of the range map in pixels, a torus of (rows, cols). */
  drawRange(rows: number, cols: number, seed = 0n): Float32Array {
    return this.runtime.drawRange(this.handle, rows, cols, seed);
  }

  /** The pattern's displacement on a torus. */
  drawPhase(rows: number, cols: number, seed = 0n): PatternPhase {
    return this.runtime.drawPhase(this.handle, rows, cols, seed);
  }

  /** Cells of the pattern of one subspace, (rows, cols, CELL_VALUES). */
  pattern(subspace: number): Float32Array {
    const { rows, cols } = this.description.pattern!;
    return this.runtime.pattern(this.handle, subspace, rows * cols);
  }

  /** Moments of the textures of all subspaces on a torus. */
  moments(rows: number, cols: number, seed = 0n): TextureMoments {
    return this.runtime.moments(this.handle, this.description.subspaces.length, rows, cols, seed);
  }

  /** Draws one texture after the other and gives each to `take`. */
  draw(options: DrawOptions, take: TakeTexture): void {
    this.runtime.draw(this.handle, this.description.bands, options, take);
  }

  /** The subspace of the measured pair nearest to two directions [theta, phi] in radians. */
  nearestSubspace(view: [number, number], light: [number, number]): number {
    return this.runtime.nearest(this.handle, view, light);
  }

  unload(): void {
    this.runtime.unload(this.handle);
  }
}
