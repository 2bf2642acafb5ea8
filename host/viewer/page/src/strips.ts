// Figures over time, as the band between the lowest and the highest tick of each frame.

import type { Range } from './messages';

const SHOWN = 600; // frames: ten seconds

interface Line {
  colour: string; // a CSS variable
  values: Range[];
}

export class Strip {
  private lines: Line[];
  private marked: number | undefined;
  private bound: number | undefined;

  /** `least`: what is always shown, so that noise near nothing does not fill the strip. */
  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly unit: string,
    private readonly least: number,
  ) {
    this.lines = [{ colour: '--accent', values: [] }, { colour: '--second', values: [] }];
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  clear(): void {
    for (const line of this.lines) line.values = [];
  }
  push(line: number, value: Range): void {
    const { values } = this.lines[line]!;
    values.push(value);
    if (values.length > SHOWN) values.shift();
  }
  /** All of it at once; a mark at one of the columns. */
  set(values: Range[], marked: number): void {
    this.lines[0]!.values = values;
    this.marked = marked;
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
    const style = getComputedStyle(canvas);
    const colour = (name: string) => resolve(canvas, style.getPropertyValue(name));
    const shown = this.marked === undefined ? SHOWN : this.lines[0]!.values.length;
    const highest = Math.max(
      this.least, this.bound ?? 0, ...this.lines.flatMap((line) => line.values.map((v) => v[1])),
    );
    const top = nice(highest);
    const y = (value: number) => height - 2 - (value / top) * (height - 6);
    context.clearRect(0, 0, width, height);
    context.lineWidth = ratio;
    context.strokeStyle = colour('--edge');
    for (const value of [0, top / 2, top]) line(context, 0, y(value), width, y(value));
    context.fillStyle = colour('--soft');
    context.font = `${11 * ratio}px system-ui, sans-serif`;
    context.fillText(`${+top.toPrecision(3)} ${this.unit}`, 4 * ratio, 12 * ratio);
    for (const one of this.lines) {
      context.strokeStyle = colour(one.colour);
      context.lineWidth = 1.4 * ratio;
      context.beginPath();
      one.values.forEach((value, i) => {
        const x = ((i + shown - one.values.length) / Math.max(shown - 1, 1)) * width;
        if (i === 0) context.moveTo(x, y(value[0]));
        context.lineTo(x, y(value[0]));
        context.lineTo(x, y(value[1]));
      });
      context.stroke();
    }
    if (this.bound !== undefined) {
      context.strokeStyle = colour('--danger');
      line(context, 0, y(this.bound), width, y(this.bound));
    }
    if (this.marked !== undefined) {
      const x = (this.marked / Math.max(shown - 1, 1)) * width;
      context.strokeStyle = colour('--danger');
      line(context, x, 0, x, height);
    }
  }
}

/** light-dark() and variables in a variable are not resolved by getPropertyValue. */
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
