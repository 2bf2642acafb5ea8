// Values over time: the band between the lowest and the highest tick of each frame.

import type { Range } from './messages';

const SHOWN_S = 10;
const AXIS_PX = 13; // height of the numbers of the time axis
const LABEL_PX = 90; // between two of them, at least

interface Point {
  t_s: number;
  range: Range;
}

interface Line {
  colour: string; // a CSS variable
  values: Point[];
}

/** Pixels of the drawing area, and the times at its ends. */
interface Frame {
  ratio: number; // pixels of a CSS pixel
  width: number;
  bottom: number;
  from_s: number;
  to_s: number;
}

export class Strip {
  private lines: Line[];
  private span: Range | undefined; // of a recording; otherwise the last seconds
  private marked_s: number | undefined;
  private bound: number | undefined;

  /** `least`: smallest upper end of the scale; keeps noise near zero small. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly unit: string,
    private readonly least: number,
  ) {
    this.lines = [
      { colour: '--accent', values: [] },
      { colour: '--second', values: [] },
    ];
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  clear(): void {
    for (const line of this.lines) line.values = [];
    this.span = undefined;
    this.marked_s = undefined;
  }
  /** Drops the lines from this one on. */
  keep(lines: number): void {
    for (const line of this.lines.slice(lines)) line.values = [];
  }
  push(line: number, t_s: number, range: Range): void {
    const { values } = this.lines[line];
    const last = values[values.length - 1];
    if (last && t_s < last.t_s) values.length = 0; // a new session
    values.push({ t_s, range });
    while (values[0].t_s < t_s - SHOWN_S) values.shift();
  }
  /** Shows a recording: columns of equal length between two times. */
  set(columns: Range[], span: Range): void {
    const step = (span[1] - span[0]) / Math.max(columns.length - 1, 1);
    this.lines[0].values = columns.map((range, i) => ({ t_s: span[0] + i * step, range }));
    this.span = span;
  }
  /** Marks a time of a recording. */
  set mark(t_s: number) {
    this.marked_s = t_s;
  }
  set limit(value: number | undefined) {
    this.bound = value;
  }

  draw(): void {
    const { canvas } = this;
    const ratio = window.devicePixelRatio;
    const width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientHeight * ratio);
    const context = canvas.getContext('2d');
    if (!context || width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const [from_s, to_s] = this.times();
    const frame = { ratio, width, bottom: height - AXIS_PX * ratio, from_s, to_s };
    context.clearRect(0, 0, width, height);
    context.font = `${11 * ratio}px system-ui, sans-serif`;
    this.drawTimes(context, frame);
    this.drawValues(context, frame);
  }

  private times(): Range {
    if (this.span) return this.span;
    const newest = Math.max(...this.lines.map((line) => line.values[line.values.length - 1]?.t_s ?? 0));
    return [newest - SHOWN_S, newest];
  }

  private colour(name: string): string {
    return resolve(this.canvas, getComputedStyle(this.canvas).getPropertyValue(name));
  }

  private drawTimes(context: CanvasRenderingContext2D, frame: Frame): void {
    const { ratio, width, bottom, from_s, to_s } = frame;
    const length = Math.max(to_s - from_s, 1e-9);
    // Live times count from now; those of a recording from its start.
    const zero = this.span ? 0 : to_s;
    const step = nice((LABEL_PX * ratio * length) / width);
    context.lineWidth = ratio;
    context.textAlign = 'center';
    for (let i = Math.ceil((from_s - zero) / step); i * step + zero <= to_s + 1e-9; ++i) {
      const x = ((i * step + zero - from_s) / length) * width;
      const text = i === 0 && !this.span ? 'now' : `${+(i * step).toPrecision(6)} s`;
      context.strokeStyle = this.colour('--edge');
      line(context, x, 0, x, bottom);
      context.fillStyle = this.colour('--soft');
      const half = context.measureText(text).width / 2;
      context.fillText(text, Math.min(Math.max(x, half), width - half), bottom + (AXIS_PX - 2) * ratio);
    }
    context.textAlign = 'left';
  }

  private drawValues(context: CanvasRenderingContext2D, frame: Frame): void {
    const { ratio, width, bottom, from_s, to_s } = frame;
    const values = this.lines.flatMap((line) => line.values.map((value) => value.range[1]));
    const top = nice(values.reduce((a, b) => Math.max(a, b), Math.max(this.least, this.bound ?? 0)));
    const x = (t_s: number) => ((t_s - from_s) / Math.max(to_s - from_s, 1e-9)) * width;
    const y = (value: number) => bottom - 1 - (value / top) * (bottom - 5);
    context.strokeStyle = this.colour('--edge');
    for (const value of [0, top / 2, top]) line(context, 0, y(value), width, y(value));
    context.fillStyle = this.colour('--soft');
    context.fillText(`${+top.toPrecision(3)} ${this.unit}`, 4 * ratio, 12 * ratio);
    context.lineWidth = 1.4 * ratio;
    for (const one of this.lines) {
      context.strokeStyle = this.colour(one.colour);
      context.beginPath();
      one.values.forEach(({ t_s, range }, i) => {
        if (i === 0) context.moveTo(x(t_s), y(range[0]));
        context.lineTo(x(t_s), y(range[0]));
        context.lineTo(x(t_s), y(range[1]));
      });
      context.stroke();
    }
    context.strokeStyle = this.colour('--danger');
    if (this.bound !== undefined) line(context, 0, y(this.bound), width, y(this.bound));
    if (this.marked_s !== undefined) line(context, x(this.marked_s), 0, x(this.marked_s), bottom);
  }
}

/** getPropertyValue does not resolve light-dark() and nested variables. */
const resolved = new Map<string, string>();
function resolve(element: HTMLElement, value: string): string {
  const scheme = document.documentElement.dataset.theme ?? matchMedia('(prefers-color-scheme: dark)').matches;
  const key = `${scheme} ${value}`;
  let colour = resolved.get(key);
  if (!colour) {
    const before = element.style.color;
    element.style.color = value;
    colour = getComputedStyle(element).color;
    element.style.color = before;
    resolved.set(key, colour);
  }
  return colour;
}

function line(context: CanvasRenderingContext2D, x0: number, y0: number, x1: number, y1: number): void {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

/** 1, 2 or 5 times a power of ten, at least `value`. */
function nice(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value) ?? value;
}
