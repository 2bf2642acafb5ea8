// A board that `tactree simulate` runs, and the page of `tactree view --port` beside it.
import { rmSync, symlinkSync } from 'node:fs';
import { join } from 'node:path';
import { bumpySphere, buildModel, folder, startBoard, startServer } from './setup.mjs';

export const RADIUS = 0.03;
export const blob = buildModel('ball', bumpySphere(8000, RADIUS, 0), ['--unit', 'm']);
export const small = { viewport: { width: 700, height: 480 } };
// The board's port under a name that stays, as a cable's does.
export const cable = join(folder, 'cable');

/** A board at the cable's end until the test is over. */
export async function plugIn(t, ...options) {
  const board = await startBoard([blob, '--script', 'press', ...options]);
  t.after(board.stop);
  rmSync(cable, { force: true });
  symlinkSync(board.port, cable);
  return board;
}

// The longest there is: the computer of a test may be busy.
export async function watch(t) {
  const server = await startServer([blob, '--port', cable, '--link-timeout', '100']);
  t.after(server.stop);
  return server;
}
