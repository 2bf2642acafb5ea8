// What is told of a board, beside what its ticks tell.

import { find } from './panel';
import type { Board, Frame } from './messages';

export class BoardView {
  private told = 0;
  private listening = false;

  /** `note`: for what the board refuses. */
  constructor(private readonly note: (text: string) => void) {}

  hello(): void {
    this.listening = false;
  }

  show(frame: Frame): void {
    const { board, news } = frame;
    find('board-gone').hidden = !board || board.link === 'here';
    find('model-warning').hidden = board?.model !== 'other';
    find('confirm').hidden = !board?.confirm;
    find<HTMLButtonElement>('arm').disabled = board !== undefined && board.link !== 'here';
    if (board) this.describe(board);
    if (!news) return;
    // What was told before this page came is of no use to it.
    if (this.listening && news.number > this.told) this.note(news.text);
    this.listening = true;
    this.told = news.number;
  }

  private describe(board: Board): void {
    const waits = board.link === 'gone' ? ' It is shown again when it is back; nothing is armed by itself.' : '';
    set('board-why', board.why + waits);
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
