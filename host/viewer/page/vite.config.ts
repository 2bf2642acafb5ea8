import { defineConfig } from 'vite';

// Fixed names, in three files: they become part of the program.
export default defineConfig({
  build: {
    target: 'es2022',
    chunkSizeWarningLimit: 1000,
    modulePreload: false,
    rollupOptions: {
      output: { entryFileNames: 'assets/page.js', assetFileNames: 'assets/page[extname]' },
    },
  },
});
