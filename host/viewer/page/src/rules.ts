// Materials by the colours of the scan: a click on a colour gives its points the contact of the sliders.
// The result is a file for `tactree build --material`.

import type { ScanColour } from './cloud';
import { CONTACT, find, settingOf } from './panel';

type Contact = Record<(typeof CONTACT)[number], number>;
const TOLERANCE = 30; // the default of a file of materials

const contactOfSliders = (): Contact =>
  Object.fromEntries(CONTACT.map((key) => [key, settingOf(key)])) as Contact;

function describe(contact: Contact): string {
  const texture =
    contact.texture_height_m > 0
      ? `, texture ${Number((1e3 * contact.texture_height_m).toPrecision(3))} mm`
      : '';
  return `${contact.stiffness_N_m} N/m, friction ${contact.static_friction} / ${contact.dynamic_friction}${texture}`;
}

export class Rules {
  private colours: ScanColour[] = [];
  private readonly rules = new Map<string, Contact>(); // by colour

  constructor() {
    find('rules-save').addEventListener('click', () => this.save());
  }

  /** The colours of the scan, most frequent first; rules of other colours are forgotten. */
  show(colours: ScanColour[]): void {
    this.colours = colours;
    const known = new Set(colours.map(({ rgb }) => rgb.join()));
    for (const key of this.rules.keys()) if (!known.has(key)) this.rules.delete(key);
    find('rules').hidden = colours.length === 0;
    this.list();
  }

  private list(): void {
    find('rule-list').replaceChildren(...this.colours.map((colour) => this.row(colour)));
    find<HTMLButtonElement>('rules-save').disabled = this.rules.size === 0;
  }

  private row({ rgb, points }: ScanColour): HTMLElement {
    const key = rgb.join();
    const rule = this.rules.get(key);
    const row = document.createElement('li');
    const choose = document.createElement('button');
    choose.type = 'button';
    choose.title = 'Give the points of this colour the contact of the sliders';
    const swatch = document.createElement('i');
    swatch.style.background = `rgb(${key})`;
    const text = rule ? describe(rule) : `${points.toLocaleString('en')} points`;
    choose.append(swatch, text);
    choose.addEventListener('click', () => this.set(key, contactOfSliders()));
    row.append(choose);
    if (rule) row.append(this.remover(key));
    return row;
  }
  private remover(key: string): HTMLElement {
    const remove = document.createElement('button');
    remove.type = 'button';
    remove.className = 'quiet';
    remove.textContent = '×';
    remove.setAttribute('aria-label', `Remove the material of the colour ${key}`);
    remove.addEventListener('click', () => this.set(key, undefined));
    return remove;
  }

  private set(key: string, contact: Contact | undefined): void {
    if (contact) this.rules.set(key, contact);
    else this.rules.delete(key);
    this.list();
  }

  /** The sliders give the material of all other points. */
  private save(): void {
    const colours = this.colours.flatMap(({ rgb }, i) => {
      const rule = this.rules.get(rgb.join());
      return rule ? [{ name: `colour ${i + 1}`, rgb, tolerance: TOLERANCE, ...rule }] : [];
    });
    const text = `${JSON.stringify({ default: contactOfSliders(), colours }, undefined, 1)}\n`;
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
    link.download = 'materials.json';
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }
}
