// Controls of a recorded trace: scrub, step, play.

import type { Command, Frame, Hello, Range } from './messages';
import { find, outputOf } from './panel';
import type { Strip } from './strips';

export class Player {
  private readonly scrub = find<HTMLInputElement>('scrub');
  private readonly play = find<HTMLButtonElement>('play');
  private playing = 0;

  constructor(
    private readonly say: (command: Command) => void,
    private readonly force: Strip,
    private readonly penetration: Strip,
  ) {
    this.scrub.addEventListener('input', () => say({ do: 'seek', tick: Number(this.scrub.value) }));
    find('step-back').addEventListener('click', () => this.step(-1));
    find('step-on').addEventListener('click', () => this.step(1));
    const speed = find<HTMLSelectElement>('speed');
    this.play.addEventListener('click', () =>
      say({ do: 'play', speed: this.playing > 0 ? 0 : Number(speed.value) }),
    );
    speed.addEventListener(
      'change',
      () => this.playing > 0 && say({ do: 'play', speed: Number(speed.value) }),
    );
  }

  step(ticks: number): void {
    this.say({ do: 'step', ticks });
  }

  hello(hello: Hello): void {
    find('player').hidden = hello.source !== 'trace';
    const { overview } = hello;
    if (overview) {
      const span: Range = [hello.begin_s ?? 0, hello.end_s ?? 0];
      this.force.set(overview.force_N, span);
      const millimetres = overview.penetration_m.map((v): Range => [1e3 * v[0], 1e3 * v[1]]);
      this.penetration.set(millimetres, span);
    }
    this.scrub.max = String((hello.ticks ?? 1) - 1);
  }

  show(frame: Frame): void {
    if (frame.tick === undefined) return;
    this.playing = frame.playing ?? 0;
    this.play.textContent = this.playing > 0 ? 'Pause' : 'Play';
    if (document.activeElement !== this.scrub || this.playing > 0) this.scrub.value = String(frame.tick);
    outputOf('scrub').value = `${frame.tick} of ${this.scrub.max}, ${frame.t_s.toFixed(4)} s`;
    this.force.mark = frame.t_s;
    this.penetration.mark = frame.t_s;
  }
}
