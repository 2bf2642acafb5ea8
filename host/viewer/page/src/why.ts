// Why the hand feels no force.

import type { Frame } from './messages';
import { find } from './panel';

/** What to do: on the page, at a board that is operated by its button, or in another program. */
function act(frame: Frame, onPage: string): string {
  if (frame.board?.shared) return 'a program in command of tactree serve has to do this';
  return frame.board?.watch_only ? 'hold the button of the board for 1 s' : onPage;
}

/** The reason; '' if there may be a force, and for a recorded trace. */
function reasonOf(frame: Frame): string {
  const [run] = frame.runs;
  if (!run || frame.tick !== undefined) return '';
  const isWaiting = run.limits.includes('waiting');
  if (run.state === 'fault')
    return `No force until the fault is cleared: ${act(frame, 'press Clear, then Arm')}`;
  if (run.limits.includes('not-homed'))
    return `not homed: hold the device in its home pose and ${act(frame, 'press Home')}`;
  if (run.state === 'idle') return `stopped: ${act(frame, 'press Arm')}`;
  if (isWaiting) return 'No force until the hand has left the object';
  if (run.state === 'armed') return 'armed: waits for the dead-man control';
  return run.state === 'active' ? (run.note ?? '') : `No force: the controller is in state ${run.state}`;
}

/** Shows the reason beside the state, and what does not fit to the device. */
export class Why {
  reason = '';

  show(frame: Frame): void {
    this.reason = reasonOf(frame);
    set('why', this.reason);
    const run = frame.runs[0];
    find('home').hidden = !run?.limits.includes('not-homed') || (frame.board?.watch_only ?? false);
    find('inside').hidden = !run?.limits.includes('waiting');
    const warning = frame.fit?.warning ?? '';
    find('fit').hidden = warning === '';
    find('scale').hidden = !frame.fit?.can_scale;
    set('fit-warning', warning);
  }
}

function set(id: string, text: string): void {
  const element = find(id);
  if (element.textContent !== text) element.textContent = text;
}
