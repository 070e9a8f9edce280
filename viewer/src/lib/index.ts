// SPDX-License-Identifier: Apache-2.0
// The package `sateen`: materials in the browser.
export { loadMaterial, Material, type DrawProgress } from './material';
export { type Description, type DrawOptions, type MaterialData, SateenError, type SubspaceDescription } from './runtime';
export {
  SateenMaterial, type SateenMaterialOptions, subspaceColours, type ViewMode,
} from './sateen_material';
