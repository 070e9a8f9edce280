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
  worker: { format: 'es' },
});
