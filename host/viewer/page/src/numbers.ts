// All values of the displayed tick as a table, with nine digits: enough to identify a float32.

import type { Frame, Run, Triple } from './messages';
import { find } from './panel';

const exact = (value: number): string => String(Number(value.toPrecision(9)));

function vector(name: string, unit: string, v: Triple): [string, string][] {
  return (['x', 'y', 'z'] as const).map((axis, i) => [`${name}_${axis}${unit}`, exact(v[i])]);
}

function friction(run: Run): string {
  if (!run.in_contact) return 'free';
  if (run.slipping === null) return 'in contact';
  return run.slipping ? 'slipping' : 'sticking';
}

function rows(frame: Frame, run: Run): [string, string][] {
  return [
    ...(frame.tick === undefined ? [] : ([['tick', String(frame.tick)]] as [string, string][])),
    ['t_s', exact(run.t_s)],
    ['state', run.state],
    ...vector('probe', '_m', run.probe_m),
    ...vector('proxy', '_m', run.proxy_m),
    ...vector('force', '_N', run.force_N),
    ...(run.motor_force_N ? vector('motor_force', '_N', run.motor_force_N) : []),
    ...(run.gravity_force_N ? vector('gravity_force', '_N', run.gravity_force_N) : []),
    ...(run.added_force_N ? vector('added_force', '_N', run.added_force_N) : []),
    ['penetration_m', exact(run.penetration_m)],
    ['friction', friction(run)],
    ...vector('normal', '', run.normal),
    ...vector('velocity', '_m_s', run.velocity_m_s),
    ...(run.tip_m ? vector('tip', '_m', run.tip_m) : []),
    ['strength', exact(run.strength)],
    ['overruns', String(run.overruns)],
    ...(frame.board ? ([['load', exact(frame.board.load)]] as [string, string][]) : []),
  ];
}

export class Numbers {
  private readonly body = find<HTMLTableElement>('numbers').tBodies[0];
  private readonly cells = new Map<string, HTMLTableCellElement>();

  show(frame: Frame): void {
    const run = frame.runs[0];
    if (!run) return;
    const wanted = rows(frame, run);
    if (wanted.length !== this.cells.size) this.clear();
    for (const [name, value] of wanted) this.cell(name).textContent = value;
  }

  clear(): void {
    this.cells.clear();
    this.body.replaceChildren();
  }

  private cell(name: string): HTMLTableCellElement {
    let cell = this.cells.get(name);
    if (!cell) {
      const row = this.body.insertRow();
      const head = document.createElement('th');
      head.scope = 'row';
      head.textContent = name;
      row.append(head);
      cell = row.insertCell();
      cell.dataset.name = name;
      this.cells.set(name, cell);
    }
    return cell;
  }
}
