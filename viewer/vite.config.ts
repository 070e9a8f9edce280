// SPDX-License-Identifier: Apache-2.0
import { defineConfig } from 'vite';

export default defineConfig({
  base: './',
  build: {
    target: 'es2022',
    assetsInlineLimit: 1 << 24,
    chunkSizeWarningLimit: 2000,
    modulePreload: false,
    rollupOptions: { output: { inlineDynamicImports: true } },
  },
  // From a disk, browsers start only classic workers out of memory.
  worker: { format: 'iife' },
});
