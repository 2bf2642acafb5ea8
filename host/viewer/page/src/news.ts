// Messages of the server: refused commands, and commands without the expected result.

import type { Frame } from './messages';
import { find } from './panel';

const SHOWN_MS = 10_000;
// A change of state that comes later is not what the message is about.
const OUTCOME_MS = 1000;

export class News {
  private readonly box = find('note');
  private timer = 0;
  private number = 0;
  private hasFrame = false;
  private state = '';
  private shown_ms = 0;

  hello(): void {
    this.hasFrame = false;
    this.hide();
  }

  /** Shows the frame's message, if it is a new one. True: it did. */
  follow(frame: Frame): boolean {
    this.followState(frame.runs[0]?.state ?? '');
    const { news } = frame;
    if (!news) return false;
    // The first frame may repeat a message from before this page connected.
    const isNew = this.hasFrame && news.number !== this.number && news.text !== '';
    this.hasFrame = true;
    this.number = news.number;
    if (isNew) this.show(news.text);
    return isNew;
  }

  show(text: string): void {
    this.box.textContent = text;
    this.box.hidden = false;
    this.shown_ms = performance.now();
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => this.hide(), SHOWN_MS);
  }

  private hide(): void {
    this.box.hidden = true;
  }

  /** A message of an earlier state is no longer true. */
  private followState(state: string): void {
    if (state !== this.state && performance.now() - this.shown_ms > OUTCOME_MS) this.hide();
    this.state = state;
  }
}
