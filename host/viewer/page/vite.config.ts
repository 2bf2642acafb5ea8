import { defineConfig } from 'vite';

// Three files with fixed names: host/viewer/cmake/Page.cmake embeds them in the program.
export default defineConfig({
  build: {
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    modulePreload: false,
    rollupOptions: { output: { entryFileNames: 'assets/page.js', assetFileNames: 'assets/page[extname]' } },
  },
});
