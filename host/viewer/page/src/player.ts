// A recorded trace: scrub, step, play.

import { outputOf, find } from './panel';
import type { Command, Frame, Hello, Range } from './messages';
import type { Strip } from './strips';

export class Player {
  private readonly scrub = find<HTMLInputElement>('scrub');
  private readonly play = find<HTMLButtonElement>('play');
  private overview: Hello['overview'];
  private playing = 0;

  constructor(private readonly say: (command: Command) => void) {
    this.scrub.addEventListener('input', () => say({ do: 'seek', tick: Number(this.scrub.value) }));
    find('step-back').addEventListener('click', () => this.step(-1));
    find('step-on').addEventListener('click', () => this.step(1));
    const speed = find<HTMLSelectElement>('speed');
    this.play.addEventListener('click', () =>
      say({ do: 'play', speed: this.playing > 0 ? 0 : Number(speed.value) }));
    speed.addEventListener('change', () => this.playing > 0 && say({ do: 'play', speed: Number(speed.value) }));
  }

  step(ticks: number): void {
    this.say({ do: 'step', ticks });
  }

  hello(hello: Hello): void {
    find('player').hidden = hello.source !== 'trace';
    this.overview = hello.overview;
    this.scrub.max = String((hello.ticks ?? 1) - 1);
  }

  show(frame: Frame, force: Strip, penetration: Strip): void {
    if (frame.tick === undefined || !this.overview) return;
    this.playing = frame.playing ?? 0;
    this.play.textContent = this.playing > 0 ? 'Pause' : 'Play';
    if (document.activeElement !== this.scrub || this.playing > 0) this.scrub.value = String(frame.tick);
    outputOf('scrub').value = `${frame.tick} of ${this.scrub.max}, ${frame.t_s.toFixed(4)} s`;
    const share = frame.tick / Math.max(Number(this.scrub.max), 1);
    const mark = (columns: Range[]) => share * (columns.length - 1);
    force.set(this.overview.force_N, mark(this.overview.force_N));
    const millimetres = this.overview.penetration_m.map((v): Range => [1e3 * v[0], 1e3 * v[1]]);
    penetration.set(millimetres, mark(millimetres));
  }
}
