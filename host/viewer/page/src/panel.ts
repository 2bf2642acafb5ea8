// The controls beside the picture: send changes to the server and follow its settings.

import type { Command, Hello, Settings } from './messages';

type Say = (command: Command) => void;
/** Settings of a contact with a slider each; also the keys of a material. */
export const CONTACT = [
  'stiffness_N_m',
  'damping_Ns_m',
  'static_friction',
  'dynamic_friction',
  'texture_height_m',
  'texture_wavelength_m',
] as const;
const SLIDERS = [...CONTACT, 'force_max_N'] as const;

export function find<T extends HTMLElement = HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no #${id}`);
  return element as T;
}

export function outputOf(id: string): HTMLOutputElement {
  const element = document.querySelector<HTMLOutputElement>(`output[for='${id}']`);
  if (!element) throw new Error(`the page has no output for #${id}`);
  return element;
}

/** Values of a slider's step, in the unit of its setting. */
const scaleOf = (slider: HTMLInputElement): number => Number(slider.dataset.scale ?? 1);

/** The setting that a slider shows. */
export function settingOf(id: string): number {
  const slider = find<HTMLInputElement>(id);
  return Number((Number(slider.value) * scaleOf(slider)).toPrecision(6));
}

export class Panel {
  private edited: Partial<Settings> = {}; // what the user has set and the server has not reported yet
  private isSimulated = false;
  private asked: Partial<Settings> | undefined; // what a restart would change

  constructor(private readonly say: Say) {
    for (const id of SLIDERS) {
      const slider = find<HTMLInputElement>(id);
      slider.addEventListener('input', () => {
        this.edited[id] = settingOf(id);
        this.label(slider);
        if (this.isSimulated && id !== 'force_max_N') this.set(id, settingOf(id));
      });
      slider.addEventListener('change', () => this.set(id, settingOf(id)));
    }
    const mode = find<HTMLSelectElement>('mode');
    mode.addEventListener('change', () => {
      this.edited.mode = mode.value as NonNullable<Settings['mode']>;
      this.set('mode', mode.value);
    });
    const rate = find<HTMLSelectElement>('rate_hz');
    rate.addEventListener('change', () => this.ask('Rate', rate, { rate_hz: Number(rate.value) }));
    const device = find<HTMLSelectElement>('device');
    device.addEventListener('change', () => this.ask('Device', device, { device: device.value }));
    find('ask-restart').addEventListener('click', () => {
      this.say({ do: 'set', ...this.asked, restart: true });
      this.answered();
    });
    find('ask-cancel').addEventListener('click', () => this.answered());
    const materials = find<HTMLInputElement>('use_materials');
    materials.addEventListener('change', () => {
      this.edited.use_materials = materials.checked;
      this.set('use_materials', materials.checked);
    });
    find('clear-injections').addEventListener('click', () => say({ do: 'clear_injections' }));
  }

  hello(hello: Hello): void {
    this.isSimulated = hello.source === 'simulation';
    this.answered();
    find<HTMLSelectElement>('device').replaceChildren(
      ...(hello.devices ?? []).map((device) => {
        const option = new Option(device.name, device.name);
        option.title = device.about;
        return option;
      }),
    );
    find('injections').replaceChildren(...(hello.injections ?? []).map((one) => this.injection(one)));
    find('materials').hidden = !hello.has_materials;
    for (const control of document.querySelectorAll<HTMLButtonElement | HTMLSelectElement>(
      '.simulated button, .simulated select',
    ))
      control.disabled = hello.source === 'board';
  }

  /** Shows the server's settings, except in the control that the user is changing. */
  follow(settings: Settings): void {
    if (settings.force_limit_N) find<HTMLInputElement>('force_max_N').max = String(settings.force_limit_N);
    for (const id of SLIDERS) {
      const slider = find<HTMLInputElement>(id);
      const edited = this.edited[id] ?? settings[id];
      const isReported = Math.abs(settings[id] - edited) < 0.5 * Number(slider.step) * scaleOf(slider);
      if (this.follows(id, slider, isReported)) {
        slider.value = String(settings[id] / scaleOf(slider));
        this.label(slider);
      }
    }
    const mode = find<HTMLSelectElement>('mode');
    if (settings.mode && this.follows('mode', mode, (this.edited.mode ?? settings.mode) === settings.mode))
      this.choose('mode', settings.mode);
    this.choose('rate_hz', String(settings.rate_hz));
    if (settings.device) this.choose('device', settings.device);
    const materials = find<HTMLInputElement>('use_materials');
    const wanted = this.edited.use_materials ?? settings.use_materials;
    if (this.follows('use_materials', materials, wanted === settings.use_materials))
      materials.checked = settings.use_materials;
    find('materials-note').hidden = find('materials').hidden || !settings.use_materials;
    find('stability').textContent =
      `Stable up to ${Math.floor(settings.stiffness_limit_N_m)} N/m with a hand`;
  }

  /** The server refused a change: shows its settings again. */
  refused(): void {
    this.edited = {};
    if (document.activeElement instanceof HTMLElement) document.activeElement.blur();
  }

  /** True if a control shows the server's value: that has become the user's, or the user has left the control. */
  private follows(id: keyof Settings, control: HTMLElement, isReported: boolean): boolean {
    if (!isReported && document.activeElement === control) return false;
    delete this.edited[id];
    return true;
  }

  private choose(id: string, value: string): void {
    const select = find<HTMLSelectElement>(id);
    if (document.activeElement === select && select.matches(':open')) return;
    if (![...select.options].some((option) => option.value === value)) select.add(new Option(value, value));
    select.value = value;
  }

  /** The page shows the present value until the restart is confirmed. */
  private ask(name: string, select: HTMLSelectElement, change: Partial<Settings>): void {
    this.asked = change;
    find('ask-text').textContent =
      `${name} ${select.selectedOptions[0]?.text}: the simulation restarts, and its recorded ticks are lost.`;
    find('ask').hidden = false;
    select.blur();
  }
  private answered(): void {
    this.asked = undefined;
    find('ask').hidden = true;
  }

  private set(key: keyof Settings, value: unknown): void {
    const friction: Record<string, unknown> = {};
    // The dynamic coefficient must not exceed the static one.
    if (key === 'static_friction' || key === 'dynamic_friction') {
      const other = key === 'static_friction' ? 'dynamic_friction' : 'static_friction';
      const slider = find<HTMLInputElement>(other);
      const bound = key === 'static_friction' ? Math.min : Math.max;
      friction[other] = bound(Number(slider.value), value as number);
    }
    this.say({ do: 'set', [key]: value, ...friction });
  }

  private label(slider: HTMLInputElement): void {
    outputOf(slider.id).value = `${Number(slider.value)} ${slider.dataset.unit ?? ''}`;
  }

  private injection(one: { fault: string; about: string }): HTMLElement {
    const button = document.createElement('button');
    button.textContent = one.fault;
    const about = document.createElement('small');
    about.textContent = one.about.replace(/^=\w+: /, '');
    button.append(about);
    button.addEventListener('click', () => this.say({ do: 'inject', fault: one.fault }));
    return button;
  }
}
