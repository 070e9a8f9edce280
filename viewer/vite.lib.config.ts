// SPDX-License-Identifier: Apache-2.0
// The package: one module with worker, shader and runtime inside; three.js stays outside.
import { defineConfig } from 'vite';

export default defineConfig({
  build: {
    target: 'es2022',
    outDir: 'dist/lib',
    lib: { entry: 'src/lib/index.ts', formats: ['es'], fileName: () => 'sateen.js' },
    rollupOptions: { external: ['three'] },
  },
  worker: { format: 'iife' },
});
