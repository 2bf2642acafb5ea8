// State of a board apart from its ticks: connection, model and recording.

import type { Board, Command, Frame, Recording } from './messages';
import { find } from './panel';

export class BoardView {
  private readonly record = find<HTMLButtonElement>('record');
  private isRecording = false;

  constructor(say: (command: Command) => void) {
    this.record.addEventListener('click', () => say({ do: this.isRecording ? 'end_recording' : 'record' }));
  }

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
    set(
      'watch-only',
      `The board is ${board?.shared ? 'shared by tactree serve' : 'operated by its button'}. This page may watch and stop it.`,
    );
    if (board) this.describe(board);
    if (board && frame.recording) this.showRecording(frame.recording, board.link === 'here');
  }

  private showRecording(recording: Recording, isConnected: boolean): void {
    this.isRecording = recording.state === 'on';
    this.record.disabled = recording.state === 'completing' || (!this.isRecording && !isConnected);
    set('record', this.isRecording ? 'End recording' : 'Record');
    set('recording', recording.text);
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
