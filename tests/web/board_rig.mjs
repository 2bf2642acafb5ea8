// A board simulated by `tactree simulate`, and the page of `tactree view --port` with it.
import { rmSync, symlinkSync } from 'node:fs';
import { join } from 'node:path';
import { bumpySphere, buildModel, folder, startBoard, startServer } from './setup.mjs';

export const RADIUS = 0.03;
export const blob = buildModel('ball', bumpySphere(8000, RADIUS, 0), ['--unit', 'm']);
export const small = { viewport: { width: 700, height: 480 } };
// A stable name for the board's port, like a cable.
export const cable = join(folder, 'cable');

/** A board at the cable's end until the test is over. */
export async function plugIn(t, ...options) {
  const board = await startBoard([blob, '--script', 'press', ...options]);
  t.after(board.stop);
  rmSync(cable, { force: true });
  symlinkSync(board.port, cable);
  return board;
}

// The maximum: the computer of a test may be busy.
export async function watch(t, ...options) {
  const server = await startServer([blob, '--port', cable, '--link-timeout', '100', ...options]);
  t.after(server.stop);
  return server;
}
