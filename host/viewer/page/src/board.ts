// State of a board apart from its ticks: connection and model.

import type { Board, Frame } from './messages';
import { find } from './panel';

export class BoardView {
  show(frame: Frame): void {
    const { board } = frame;
    find('board-gone').hidden = !board || board.link === 'here';
    find('model-warning').hidden = board?.model !== 'other';
    find('confirm').hidden = !board?.confirm;
    const isOnlyWatched = board?.watch_only ?? false;
    find<HTMLButtonElement>('arm').disabled = isOnlyWatched || (board !== undefined && board.link !== 'here');
    find<HTMLButtonElement>('clear').disabled = isOnlyWatched;
    find<HTMLFieldSetElement>('contact').disabled = isOnlyWatched;
    find('watch-only').hidden = !isOnlyWatched;
    if (board) this.describe(board);
  }

  private describe(board: Board): void {
    const reconnects =
      board.link === 'gone' ? ' The page reconnects when the board is back; the board stays disarmed.' : '';
    set('board-why', board.why + reconnects);
    find('connect').hidden = board.link !== 'taken';
    set('model-warning', board.about_model);
    set('board-model', board.about_model);
    set('board-name', `${board.name}, firmware ${board.firmware}`);
    set('confirm', `Armed: ${board.confirm}.`);
  }
}

function set(id: string, text: string): void {
  const element = find(id);
  if (element.textContent !== text) element.textContent = text;
}
