// The page of `tactree view`: connects its parts.

import './style.css';
import { BoardView } from './board';
import { Connection } from './connection';
import { Gestures } from './gestures';
import { Hand } from './hand';
import { showLegend } from './materials';
import { type Command, type Frame, type Hello, length, type Run } from './messages';
import { News } from './news';
import { Numbers } from './numbers';
import { find, outputOf, Panel } from './panel';
import { PlaceView } from './place';
import { Player } from './player';
import { Rules } from './rules';
import { Strip } from './strips';
import { View } from './view';
import { Why } from './why';

const view = new View(find<HTMLCanvasElement>('view'));
const strips = {
  force: new Strip(find<HTMLCanvasElement>('strip-force'), 'N', 1),
  penetration: new Strip(find<HTMLCanvasElement>('strip-penetration'), 'mm', 1),
  work: new Strip(find<HTMLCanvasElement>('strip-work'), '', 1000),
};
const numbers = new Numbers();
const panel = new Panel(say);
const player = new Player(say, strips.force, strips.penetration);
const board = new BoardView(say);
const news = new News();
const why = new Why();
const hand = new Hand(view, (target_m, via_m, speed_m_s) => say({ do: 'hand', target_m, via_m, speed_m_s }));
// Before the gestures: the handles take a pointer first.
const place = new PlaceView(view, say, (text) => news.show(text));
const gestures = new Gestures(view, hand, () => place.isHeld);
const rules = new Rules();
const connection = new Connection({ hello, frame, refused, connected });
let source: Hello['source'] = 'simulation';
// Of so many pictures one comes with new numbers and curves: without a GPU these take longer than the picture.
const PICTURES_PER_TELLING = 3;

function say(command: Command): void {
  if (!connection.send(command)) news.show('Not connected: the command was not sent.');
}

function connected(is: boolean): void {
  find('offline').hidden = is;
  if (!is) setState('not connected');
}

function refused(why: string): void {
  panel.refused();
  place.release();
  news.show(why);
}

function hello(message: Hello): void {
  source = message.source;
  document.body.dataset.source = source;
  const points = message.models.reduce((sum, model) => sum + model.points, 0);
  const names = message.models.map((model) => model.name || 'model').join(', ');
  const port = message.port ? ` · board at ${message.port}` : '';
  find('model-name').textContent = `${names} · ${points.toLocaleString('en')} points${port}`;
  document.title = `${names} – Tactree`;
  showNotes(message);
  hand.hello(message.hand_start_m);
  place.release();
  for (const strip of Object.values(strips)) strip.clear();
  panel.hello(message);
  news.hello();
  player.hello(message);
  view
    .load(message.models.length)
    .then(loaded)
    .catch((error: Error) => news.show(`The model could not be loaded: ${error.message}`));
}

function loaded(): void {
  find<HTMLInputElement>('octant-level').max = String(view.deepest);
  find('show-materials-row').hidden = view.materials.length < 2;
  find('show-colours-row').hidden = !view.isColoured;
  showLegend(view.materials);
  rules.show(view.colours);
  showOverlay();
}

/** Doubts about the models, such as one that lies on its side. A dismissed note does not return. */
let dismissed = '';
function showNotes(message: Hello): void {
  const notes = message.models.filter((model) => model.note !== '');
  const text = notes.map((model) => `${model.name || 'model'}: ${model.note}`).join('; ');
  find('posture-note').textContent = text;
  find('posture').hidden = text === '' || text === dismissed;
}
find('posture-close').addEventListener('click', () => {
  dismissed = find('posture-note').textContent ?? '';
  find('posture').hidden = true;
});

function setState(state: string): void {
  const pill = find('state');
  if (pill.textContent !== state) pill.textContent = state;
  pill.dataset.state = state;
}

function showFaults(run: Run): void {
  find('banner').hidden = run.faults.length === 0;
  const names = run.faults.map((fault) => fault.name);
  find('fault-names').textContent = names.join(', ');
  find('fault-about').textContent = run.faults[0]?.about ?? '';
  find<HTMLAnchorElement>('fault-page').href = `/faults/${names[0] ?? ''}`;
  showLimits(run.limits);
}

function showLimits(names: string[]): void {
  const limits = find('limits');
  if (limits.dataset.shown === names.join()) return;
  limits.dataset.shown = names.join();
  limits.replaceChildren(
    ...names.map((name) => {
      const link = document.createElement('a');
      link.href = `/faults/limit-${name}`;
      link.target = '_blank';
      link.rel = 'noopener';
      link.textContent = name;
      return link;
    }),
  );
}

function showTiming(frame: Frame, run: Run): void {
  const rate = frame.settings ? `${frame.settings.rate_hz} ticks/s` : '';
  // The deadlines of a simulation are those of the simulated board: it misses none by being skipped.
  const missed = frame.board ? 'deadlines missed' : 'deadlines missed by the simulated board';
  const lost_s = frame.lost_s ?? 0;
  const slow = lost_s >= 0.1 ? `this computer is too slow: ${lost_s.toFixed(1)} s skipped` : '';
  const load = frame.board ? `load ${(100 * frame.board.load).toFixed(0)} %` : '';
  const lost = frame.board?.dropped ? `${frame.board.dropped} messages lost` : '';
  const parts = [rate, `${run.overruns} ${missed}`, load, lost, slow].filter((part) => part !== '');
  const text = parts.join(' · ');
  const line = find('timing');
  if (line.textContent !== text) line.textContent = text;
}

function pushStrips(frame: Frame): void {
  for (const strip of Object.values(strips)) strip.keep(Math.max(frame.runs.length, 1));
  frame.runs.forEach((run, i) => {
    if (!run.strip || run.strip.ticks === 0) return;
    strips.force.push(i, frame.t_s, run.strip.force_N);
    const [low, high] = run.strip.penetration_m;
    strips.penetration.push(i, frame.t_s, [1e3 * low, 1e3 * high]);
    if (run.strip.work) strips.work.push(i, frame.t_s, run.strip.work);
  });
}

/** Work per tick against the proven bound, or the reason why it is not available. */
function showWork(frame: Frame, run: Run): void {
  const { unit, bound, why } = frame.work;
  find('work').hidden = unit === '' && !frame.board;
  find('strip-work').hidden = unit === '';
  find('work-name').textContent = unit === '' ? 'Instructions' : unit[0].toUpperCase() + unit.slice(1);
  find('work-why').textContent = why;
  strips.work.limit = bound ?? undefined;
  const highest = run.strip?.work?.[1];
  if (highest === undefined) return;
  const rounded = (value: number) => Math.round(value).toLocaleString('en');
  find<HTMLOutputElement>('work-now').value =
    rounded(highest) + (bound === null ? '' : ` of ${rounded(bound)}`);
}

let latest: Frame | undefined;
let newest_s = 0;
let poses = '';

function frame(message: Frame): void {
  latest = message;
  if (message.t_s < newest_s) hand.touch.forget(); // a new session
  newest_s = message.t_s;
  pushStrips(message);
  if (message.hand_m) hand.follow(message.hand_m);
}

let untold: Frame | undefined;
let pictures = 0;

/** Once per displayed picture, with the latest frame. */
function refresh(): void {
  requestAnimationFrame(refresh);
  if (latest) {
    view.show(latest);
    place.show(latest);
    if (latest.place?.hand_start_m) hand.setStart(latest.place.hand_start_m);
    touchMovedBodies(latest);
    untold = latest;
    latest = undefined;
  }
  pictures = (pictures + 1) % PICTURES_PER_TELLING;
  if (!untold || pictures !== 0) return;
  tell(untold);
  untold = undefined;
}

/** Everything beside the picture. */
function tell(message: Frame): void {
  document.body.dataset.mode = message.settings?.mode ?? '';
  board.show(message);
  why.show(message);
  if (news.follow(message) && message.board) {
    panel.refused();
    place.release();
  }
  if (message.settings) panel.follow(message.settings);
  const run = message.runs[0];
  if (run) showRun(message, run);
  else showNothing();
  for (const strip of Object.values(strips)) strip.draw();
}

/** A body that moves under the cursor takes the touch along. */
function touchMovedBodies(message: Frame): void {
  const now = JSON.stringify(message.bodies);
  if (now !== poses) hand.touch.refresh();
  poses = now;
}

function showRun(message: Frame, run: Run): void {
  setState(run.state);
  showFaults(run);
  showTiming(message, run);
  showWork(message, run);
  if (find<HTMLDetailsElement>('numbers-box').open) numbers.show(message);
  find<HTMLOutputElement>('force-now').value = `${length(run.force_N).toFixed(2)} N`;
  find<HTMLOutputElement>('penetration-now').value = `${(1e3 * run.penetration_m).toFixed(2)} mm`;
  showDistance(run);
  player.show(message);
}

/** The signed distance of the probe from the surface, or how deep the hand presses. */
function showDistance(run: Run): void {
  const millimetres = (metres: number) => `${(1e3 * metres).toFixed(1)} mm`;
  const under = view.under[0];
  const depth = hand.touch.pressed ? ` · hand ${millimetres(hand.touch.depth_m)} deep` : '';
  const height = under ? `${millimetres(under.height)} to the surface` : '';
  find<HTMLOutputElement>('distance').value =
    (run.in_contact && run.state === 'active' ? 'in contact' : height) + depth;
}

/** Clears all values, so that no old one looks current. */
function showNothing(): void {
  setState('no board');
  find('banner').hidden = true;
  showLimits([]);
  for (const name of ['force', 'penetration', 'work']) find<HTMLOutputElement>(`${name}-now`).value = '–';
  find('timing').textContent = '';
  find<HTMLOutputElement>('distance').value = '';
  numbers.clear();
}
requestAnimationFrame(refresh);

view.onPicture = () => {
  const { dataset } = document.documentElement;
  if (view.drawn > 0 && !dataset.firstPicture) dataset.firstPicture = String(Math.round(performance.now()));
  find('detail').textContent = `${view.drawn.toLocaleString('en')} points drawn`;
};

function stop(): void {
  say({ do: 'stop' });
}

// Space and Escape stop regardless of focus, before a focused button can handle them.
window.addEventListener(
  'keydown',
  (event) => {
    if (event.key === ' ' || event.key === 'Escape') {
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) stop();
    }
  },
  { capture: true },
);
window.addEventListener(
  'keyup',
  (event) => {
    if (event.key === ' ') event.preventDefault(); // else the focused button is pressed
  },
  { capture: true },
);
/** True where a letter belongs to a value. */
function isTyped(target: EventTarget | null): boolean {
  const isNumber = target instanceof HTMLInputElement && target.type === 'number';
  return isNumber || target instanceof HTMLSelectElement;
}
window.addEventListener('keydown', (event) => {
  if (isTyped(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'a' && source !== 'trace') say({ do: 'arm' });
  if (source === 'trace' && document.activeElement?.id === 'view') {
    if (event.key === 'ArrowRight' && !event.shiftKey) player.step(1);
    if (event.key === 'ArrowLeft' && !event.shiftKey) player.step(-1);
  }
});

find('view').addEventListener('pointerdown', () => {
  if (why.reason !== '') news.show(why.reason);
});
find('scale').addEventListener('click', () => say({ do: 'fit' }));
find('stop').addEventListener('click', stop);
find('home').addEventListener('click', () => say({ do: 'home' }));
find('arm').addEventListener('click', () => say({ do: 'arm' }));
find('connect').addEventListener('click', () => say({ do: 'connect' }));
find('clear').addEventListener('click', () => say({ do: 'clear' }));
find('reset-view').addEventListener('click', () => gestures.reset());
find('hand-back').addEventListener('click', () => hand.bringBack());

const shown = () =>
  view.setShown({
    device: find<HTMLInputElement>('show-device').checked,
    patch: find<HTMLInputElement>('show-patch').checked,
  });
find('show-device').addEventListener('change', shown);
find('show-patch').addEventListener('change', shown);

const showsMaterials = find<HTMLInputElement>('show-materials');
const showsColours = find<HTMLInputElement>('show-colours');
function showOverlay(): void {
  const isShown = showsMaterials.checked && view.materials.length > 1;
  find('material-list').hidden = !isShown;
  if (isShown) view.showOverlay('materials');
  else view.showOverlay(showsColours.checked ? 'colours' : 'none');
}
// One of the two at a time.
showsMaterials.addEventListener('change', () => {
  if (showsMaterials.checked) showsColours.checked = false;
  showOverlay();
});
showsColours.addEventListener('change', () => {
  if (showsColours.checked) showsMaterials.checked = false;
  showOverlay();
});

const octants = find<HTMLInputElement>('show-octants');
const level = find<HTMLInputElement>('octant-level');
function showOctants(): void {
  find('octant-row').hidden = !octants.checked;
  outputOf('octant-level').value = level.value;
  view
    .showOctants(octants.checked ? Number(level.value) : undefined)
    .catch((error: Error) => news.show(error.message));
}
octants.addEventListener('change', showOctants);
level.addEventListener('change', showOctants);

find('save-picture').addEventListener('click', async () => {
  const picture = await view.picture();
  if (!picture) return;
  const link = document.createElement('a');
  link.href = URL.createObjectURL(picture);
  link.download = 'tactree.png';
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
});

find('theme').addEventListener('click', () => {
  const { dataset } = document.documentElement;
  const dark = dataset.theme ? dataset.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  dataset.theme = dark ? 'light' : 'dark';
});
find('panel-toggle').addEventListener('click', (event) => {
  const open = document.body.dataset.panel !== 'open';
  document.body.dataset.panel = open ? 'open' : '';
  (event.currentTarget as HTMLElement).setAttribute('aria-expanded', String(open));
});
