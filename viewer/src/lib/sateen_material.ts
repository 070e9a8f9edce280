// SPDX-License-Identifier: Apache-2.0
// A three.js material that shows a Sateen material in any scene, lit by its directional,
// ambient and hemisphere lights.
import {
  Color, DataTexture, type IUniform, ShaderMaterial, type ShaderMaterialParameters, type Texture, UniformsLib,
  UniformsUtils, Vector2, Vector3, Vector4,
} from 'three';

import type { Material } from './material';
import { LEVELS, mostGroups } from './basis';
import { latticeOf, phaseTexture, warpOf } from './pattern';
import { MOMENT_SIDE, ReliefTextures } from './relief';
import { type MaterialData, START_SIDE } from './runtime';
import evaluation from './sateen.glsl?raw';
import {
  basisTextures, byGroup, directionTextures, keptTexture, LIST_COLS, skyOf, subspaceTexture,
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
  /**
   * Texels a fetch may take along a slanted pixel; 1 for renderers in software, which are slow at it.
   * Unless told, 1 as of three.js's textures.
   */
  anisotropy?: number;
  /** Show the one tile over and over, as `sateen render` does, instead of blending shifted ones. */
  repeat?: boolean;
  onProgress?: (share: number) => void;
  /**
   * Compiles, as WebGLRenderer.compileAsync in the scene that the material is for. Called at once with a material of the
   * shader that is probably needed, so that it compiles while the fields are drawn, and in the end with the material.
   */
  prepare?: (material: ShaderMaterial) => Promise<unknown>;
  signal?: AbortSignal;
}

/** The shader of a material by what it has: `groups` of components, and whether there is relief. */
function shaderOf(data: MaterialData, groups: number, relief: boolean, options: SateenMaterialOptions): ShaderMaterialParameters {
  const measured = data.views.length > 0;
  const flag = (name: string, on: boolean): Record<string, number> => (on ? { [name]: 1 } : {});
  return {
    lights: true,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    defines: {
      SUBSPACES: data.subspaces.length,
      GROUPS: groups,
      LEVELS,
      LIST_COLS,
      LIST_SHIFT: Math.log2(LIST_COLS),
      START_SIDE,
      MOMENT_SIDE,
      VIEWS: data.views.length,
      ANISOTROPY: Math.round(options.anisotropy ?? 1),
      RELIEF_STEPS: 32,
      SHADOW_STEPS: 16,
      ...flag('MEASURED', measured),
      ...flag('REFLECTANCE', measured && data.appearance !== null),
      ...flag('COSINE_INCLUDED', measured && data.cosineIncluded),
      ...flag('REPEAT', options.repeat ?? false),
      ...flag('PATTERN', Boolean(data.pattern)),
      ...flag('SURFACE', relief),
      ...flag('DELIT', relief && data.surface!.delit),
    },
  };
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
  const ambient = surface.delit ? surface.ambient : 0;
  const relief = new ReliefTextures(await source.range({ rows, cols, seed }, signal), rows, cols, ambient);
  if (relief.range[1] > relief.range[0]) return relief;
  relief.dispose();
  return undefined;
}

/**
 * A material of the shader that will probably be needed, to compile it by. Components and relief are not drawn yet:
 * as many components as there may be, and relief if the file has any.
 */
function likelyMaterial(data: MaterialData, cells: Record<string, Texture>, unused: Texture, options: SateenMaterialOptions): ShaderMaterial {
  const samplers = [...evaluation.matchAll(/^uniform sampler2D (\w+)/gm)].map(([, name]) => [name!, unused] as const);
  const uniforms: Record<string, IUniform> = UniformsUtils.clone(UniformsLib.lights);
  for (const [name, value] of [...samplers, ...Object.entries(cells)]) uniforms[name] = { value };
  return new ShaderMaterial({ ...shaderOf(data, mostGroups(data.subspaces.length * data.bands), Boolean(data.surface), options), uniforms });
}

/** Colours that tell subspaces apart, by the golden angle. */
export function subspaceColours(count: number): Color[] {
  return Array.from({ length: count }, (_, k) =>
    new Color().setHSL((k * 0.381966) % 1, 0.55, 0.42 + 0.16 * (k % 3)));
}

export class SateenMaterial extends ShaderMaterial {
  readonly isSateenMaterial = true;
  private readonly owned: { dispose(): void }[] = [];
  private reliefTextures: ReliefTextures | undefined;

  private constructor(readonly description: MaterialData, parameters: ShaderMaterialParameters) {
    super(parameters);
  }

  /** Draws the fields of every subspace in the background, then makes the material. */
  static async create(source: Material, options: SateenMaterialOptions = {}): Promise<SateenMaterial> {
    const { tile = TILE, seed = 0n, texelsPerUv = [1024, 1024], repeat = false, anisotropy = 1, onProgress, prepare, signal } = options;
    const { description } = source;
    const { pattern, bands } = description;
    const measured = description.views.length > 0;
    const torus = { rows: tile, cols: tile };
    const directions = directionTextures(description);
    const unused = new DataTexture(new Uint8Array(4), 1, 1);
    const likely = prepare && likelyMaterial(description, { ...directions.textures }, unused, options);
    const prepared = likely && prepare(likely).catch(() => {});
    const drawn = async () => ({
      ...await source.basis({ ...torus, seed }, onProgress, signal), relief: await drawRelief(source, options),
    });
    const { basis, phase, relief } = await drawn().catch((error: unknown) => {
      void prepared?.then(() => likely!.dispose());
      throw error;
    });

    const sky = measured ? skyOf(description, basis) : undefined;
    const textures: Record<string, Texture> = {
      ...basisTextures(basis, anisotropy),
      ...directions.textures,
      kept: keptTexture(basis),
      subspaces: subspaceTexture(basis, bands),
      skies: sky?.texture ?? unused,
      surface: relief?.surface ?? unused,
      heights: relief?.heights ?? unused,
      moments: relief?.moments ?? unused,
      phase: phase ? phaseTexture(phase, torus.rows, torus.cols) : unused,
    };
    const inverse = phase?.inverse ?? [1, 0, 0, 1];
    const lattice = latticeOf(inverse, torus);
    // Texels of a cell's table along a texel of the torus.
    const cellTexels = pattern ? Math.sqrt(Math.abs(inverse[0]! * inverse[3]! - inverse[1]! * inverse[2]!) * pattern.rows * pattern.cols) : 1;
    const material = new SateenMaterial(description, {
      ...shaderOf(description, basis.groups.length, relief !== undefined, options),
      uniforms: UniformsUtils.merge([UniformsLib.lights, {
        texelsPerUv: { value: new Vector2(...texelsPerUv) },
        fieldSize: { value: new Vector2(torus.cols, torus.rows) },
        exponent: { value: byGroup(basis.exponent) },
        offset: { value: byGroup(basis.offset) },
        middle: { value: byGroup(basis.middle) },
        farMiddle: { value: byGroup(basis.farMiddle) },
        skyRows: { value: byGroup(sky?.rows ?? new Float32Array(12 * basis.groups.length)) },
        contrastScale: { value: directions.contrastScale },
        S_: { value: byGroup(basis.S) },
        latticeInverse: { value: new Vector4(...inverse) },
        lattice: { value: new Vector4(...lattice) },
        warp: { value: new Vector4(...(pattern && !repeat ? warpOf(pattern.inverse, inverse) : [1, 0, 0, 1])) },
        cellLevel: { value: Math.log2(cellTexels) },
        surfaceSize: { value: new Vector2(relief?.cols ?? 1, relief?.rows ?? 1) },
        leastShading: { value: relief ? relief.ambient / (1 + relief.ambient) : 0 },
        heightRange: { value: new Vector2(...(relief?.range ?? [0, 0])) },
        relief: { value: 1 },
        marched: { value: true },
        tint: { value: new Color(1, 1, 1) },
        exposure: { value: 1 },
        viewMode: { value: 0 },
        palette: { value: subspaceColours(description.subspaces.length).map((c) => new Vector3(c.r, c.g, c.b)) },
      }]),
    });
    // Not merged: that would copy the textures.
    for (const [name, value] of Object.entries(textures)) material.uniforms[name] = { value };
    material.owned.push(...Object.values(textures));
    material.reliefTextures = relief;
    if (likely) material.owned.push(likely);
    await prepare?.(material);
    onProgress?.(1);
    if (signal?.aborted) material.dispose();
    signal?.throwIfAborted();
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
    for (const part of this.owned) part.dispose();
    super.dispose();
  }
}
