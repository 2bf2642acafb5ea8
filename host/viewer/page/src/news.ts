// Messages of the server: refused commands, and commands without the expected result.

import type { Frame } from './messages';
import { find } from './panel';

const SHOWN_MS = 10_000;

export class News {
  private readonly box = find('note');
  private timer = 0;
  private number = 0;
  private hasFrame = false;

  hello(): void {
    this.hasFrame = false;
  }

  /** Shows the frame's message, if it is a new one. True: it did. */
  follow(frame: Frame): boolean {
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
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => (this.box.hidden = true), SHOWN_MS);
  }
}
