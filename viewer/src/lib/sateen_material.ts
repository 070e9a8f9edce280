// SPDX-License-Identifier: Apache-2.0
// A three.js material that shows a Sateen material in any scene, lit by its directional,
// ambient and hemisphere lights.
import {
  Color, DataTexture, ShaderMaterial, type ShaderMaterialParameters, type Texture, UniformsLib,
  UniformsUtils, Vector2, Vector3, Vector4,
} from 'three';

import type { Material } from './material';
import { fieldVariance, patternTextures, type PatternTextures, phaseTexture } from './pattern';
import { MOMENT_SIDE, ReliefTextures } from './relief';
import { type MaterialData, START_SIDE } from './runtime';
import evaluation from './sateen.glsl?raw';
import {
  ANISOTROPY, curveTexture, directionTextures, FieldTexture, hiddenTexture, LEVELS, LIST_COLS, SUBSPACE_ROWS,
  subspaceRows, toneCurveTexture,
} from './textures';

/** Side of the drawn tile, and about that of a torus of the range map, in texels. */
const TILE = 256;
const SURFACE_SIDE = 512;

/** What of a material is shown. */
export type ViewMode = 'combined' | 'smooth' | 'relief' | 'index';
const VIEW_MODES: ViewMode[] = ['combined', 'smooth', 'relief', 'index'];

export interface SateenMaterialOptions {
  /** Texels of the material along one unit of the mesh's u and v. */
  texelsPerUv?: [number, number];
  /** Side of the drawn tile in texels. */
  tile?: number;
  seed?: bigint;
  /** Show the one tile over and over, as `sateen render` does, instead of blending shifted ones. */
  repeat?: boolean;
  onProgress?: (share: number) => void;
  signal?: AbortSignal;
}

const VERTEX = /* glsl */ `
varying vec2 vUv;
varying vec3 vNormal;
varying vec3 vViewPosition;
void main() {
    vUv = uv;
    vNormal = normalMatrix * normal;
    vec4 at = modelViewMatrix * vec4(position, 1.0);
    vViewPosition = -at.xyz;
    gl_Position = projectionMatrix * at;
}`;

const FRAGMENT = /* glsl */ `
#include <common>
#include <lights_pars_begin>
${evaluation}
void main() {
    gl_FragColor = vec4(sateen_radiance(), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
}`;

/** A torus of the range map, of whole tiles unless it has to be as large as the fields' own. */
async function drawRelief(source: Material, options: SateenMaterialOptions): Promise<ReliefTextures | undefined> {
  const { surface } = source.description;
  if (!surface) return undefined;
  const { tile = TILE, seed = 0n, repeat = false, signal } = options;
  const side = (length: number): number => length * Math.max(1, Math.round(SURFACE_SIDE / length));
  const [rows, cols] = repeat ? [tile, tile] : [side(surface.rows), side(surface.cols)];
  const relief = new ReliefTextures(await source.drawRange(rows, cols, seed, signal), rows, cols);
  if (relief.range[1] > relief.range[0]) return relief;
  relief.dispose();
  return undefined;
}

interface DrawnPattern extends PatternTextures {
  phase: Texture;
  inverse: number[];
}

async function drawPattern(
  source: Material, kept: Float32Array, options: SateenMaterialOptions,
): Promise<DrawnPattern | undefined> {
  if (!source.description.pattern) return undefined;
  const { tile = TILE, seed = 0n, repeat = false, signal } = options;
  const phase = await source.drawPhase(tile, tile, seed, signal);
  const textures = patternTextures(source.description, await source.patterns(signal), kept);
  const inverse = repeat ? phase.inverse : source.description.pattern.inverse;
  return { ...textures, phase: phaseTexture(phase, tile, tile), inverse };
}

/** Colours that tell subspaces apart, by the golden angle. */
export function subspaceColours(count: number): Color[] {
  return Array.from({ length: count }, (_, k) =>
    new Color().setHSL((k * 0.381966) % 1, 0.55, 0.42 + 0.16 * (k % 3)));
}

export class SateenMaterial extends ShaderMaterial {
  readonly isSateenMaterial = true;
  private readonly owned: Texture[] = [];
  private reliefTextures: ReliefTextures | undefined;

  private constructor(readonly description: MaterialData, parameters: ShaderMaterialParameters) {
    super(parameters);
  }

  /** Draws the fields of every subspace in the background, then makes the material. */
  static async create(source: Material, options: SateenMaterialOptions = {}): Promise<SateenMaterial> {
    const { tile = TILE, seed = 0n, texelsPerUv = [1024, 1024], repeat = false, onProgress, signal } = options;
    const { description } = source;
    const subspaces = description.subspaces.length;
    const fields = new FieldTexture(tile, description.bands, subspaces);
    await source.draw({
      rows: tile, cols: tile, seed, fieldsOnly: true, onProgress, signal,
      onTexture: (k, texture) => fields.set(k, texture),
    });
    const pattern = await drawPattern(source, fields.variance, options);
    const relief = await drawRelief(source, options);
    const measured = description.views.length > 0;
    const reflectance = measured && description.appearance !== null;
    const moments = reflectance ? await source.moments(tile, tile, seed, signal) : undefined;

    const directions = directionTextures(description);
    const variance = pattern?.variance ?? fieldVariance(description, fields.variance);
    const unused = new DataTexture(new Uint8Array(4), 1, 1);
    const textures: Record<string, Texture> = {
      fields: fields.texture,
      curves: curveTexture(description.subspaces, fields.variance),
      hidden: hiddenTexture(description.subspaces, variance.hidden, variance.all),
      viewCells: directions.viewCells,
      lightCells: directions.lightCells,
      pairs: directions.pairs,
      surface: relief?.surface ?? unused,
      moments: relief?.moments ?? unused,
      ...(pattern && {
        cells: pattern.cells,
        phase: pattern.phase,
        toneCurves: toneCurveTexture(description.subspaces, pattern.ranges, variance.hidden),
      }),
    };
    const flag = (name: string, on: unknown): Record<string, number> => (on ? { [name]: 1 } : {});
    const cell = description.pattern ?? { rows: 1, cols: 1 };
    const material = new SateenMaterial(description, {
      lights: true,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      defines: {
        SUBSPACES: subspaces,
        SUBSPACE_ROWS,
        LEVELS,
        LIST_COLS,
        START_SIDE,
        MOMENT_SIDE,
        VIEWS: description.views.length,
        LIGHT_HEIGHTS: directions.lightHeights,
        CELL_HALF_TEXEL: `vec2(${0.5 / cell.cols}, ${0.5 / cell.rows})`,
        ANISOTROPY: `${ANISOTROPY}.0`,
        RELIEF_STEPS: 32,
        SHADOW_STEPS: 16,
        ...flag('MEASURED', measured),
        ...flag('REFLECTANCE', reflectance),
        ...flag('COSINE_INCLUDED', measured && description.cosineIncluded),
        ...flag('REPEAT', repeat),
        ...flag('PATTERN', pattern),
        ...flag('SURFACE', relief),
        ...flag('DELIT', relief && description.surface!.delit),
      },
      uniforms: UniformsUtils.merge([UniformsLib.lights, {
        texelsPerUv: { value: new Vector2(...texelsPerUv) },
        fieldSize: { value: new Vector2(tile, tile) },
        surfaceSize: { value: new Vector2(relief?.cols ?? 1, relief?.rows ?? 1) },
        heightRange: { value: new Vector2(...(relief?.range ?? [0, 0])) },
        latticeInverse: { value: new Vector4(...(pattern?.inverse ?? [1, 0, 0, 1])) },
        subspaces: { value: subspaceRows(description.subspaces, moments, pattern?.ranges) },
        relief: { value: 1 },
        marched: { value: true },
        tint: { value: new Color(1, 1, 1) },
        exposure: { value: 1 },
        viewMode: { value: 0 },
        palette: { value: subspaceColours(subspaces).map((c) => new Vector3(c.r, c.g, c.b)) },
      }]),
    });
    // Not merged: that would copy the textures.
    for (const [name, value] of Object.entries(textures)) material.uniforms[name] = { value };
    material.owned.push(...Object.values(textures));
    material.reliefTextures = relief;
    return material;
  }

  get texelsPerUv(): Vector2 {
    return this.uniforms.texelsPerUv!.value as Vector2;
  }
  get tint(): Color {
    return this.uniforms.tint!.value as Color;
  }
  set exposure(value: number) {
    this.uniforms.exposure!.value = value;
  }
  /** Scale of the heights; 1 is as measured. */
  set relief(value: number) {
    if (this.uniforms.relief!.value === value) return;
    this.uniforms.relief!.value = value;
    if ('DELIT' in this.defines!) this.reliefTextures!.tabulate(value);
  }
  /** Whether the relief moves the texture and casts shadows, or only shades it. */
  set marched(value: boolean) {
    this.uniforms.marched!.value = value;
  }
  set viewMode(mode: ViewMode) {
    this.uniforms.viewMode!.value = VIEW_MODES.indexOf(mode);
  }

  /** Whether there is relief to show. */
  get hasSurface(): boolean {
    return 'SURFACE' in this.defines!;
  }

  override dispose(): void {
    for (const texture of this.owned) texture.dispose();
    super.dispose();
  }
}
