// One canvas for all outlines of the gallery: it follows the window, and each outline is drawn into
// the place of its cell.
import { themeColour } from '../theme.js';
import { cellMatrix, portOf, type Port, type Rectangle, type Turn } from './layout.js';
import { LineShader, type Lines } from './line_shader.js';
import type { Shape } from './shape.js';

/// What is drawn of a cell.
export interface Picture {
  shape: Shape;
  place: Rectangle;
  turn: Turn;
  lively: boolean;
}

const LINE_WIDTH = 1.3;
const MOST_RATIO = 2;

export class Painter {
  readonly canvas: HTMLCanvasElement;
  private readonly gl: WebGL2RenderingContext | null;
  private shader: LineShader | null = null;
  private lines = new WeakMap<Shape, Lines>();
  private colours = { calm: themeColour('--outline'), lively: themeColour('--accent') };

  /// `restored`: the context was lost and is back.
  constructor(canvas: HTMLCanvasElement, restored: () => void) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', { antialias: false, depth: false, alpha: true });
    if (this.gl !== null) this.shader = new LineShader(this.gl);
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.shader = null;
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.restore();
      restored();
    });
  }

  /// False: the browser has no WebGL 2.
  get works(): boolean {
    return this.gl !== null;
  }

  themeChanged(): void {
    this.colours = { calm: themeColour('--outline'), lively: themeColour('--accent') };
  }

  paint(pictures: readonly Picture[]): void {
    const { gl, shader } = this;
    if (gl === null || shader === null) return;
    const ratio = Math.min(devicePixelRatio, MOST_RATIO);
    this.fit(ratio);
    const window = this.canvas.getBoundingClientRect();
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    shader.begin(LINE_WIDTH * ratio);
    for (const picture of pictures) {
      const port = portOf(picture.place, window, ratio);
      if (port !== null) this.draw(shader, picture, port);
    }
  }

  private restore(): void {
    this.lines = new WeakMap();
    this.shader = this.gl === null ? null : new LineShader(this.gl);
  }

  /// Moves the canvas to what is to be seen of the page.
  private fit(ratio: number): void {
    const { canvas } = this;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    canvas.style.transform = `translateY(${window.scrollY}px)`;
  }

  private linesOf(shader: LineShader, shape: Shape): Lines {
    let lines = this.lines.get(shape);
    if (lines === undefined) {
      lines = shader.upload(shape.ends);
      this.lines.set(shape, lines);
    }
    return lines;
  }

  private draw(shader: LineShader, picture: Picture, { x, y, width, height }: Port): void {
    const { shape, turn, lively } = picture;
    const matrix = cellMatrix(shape.ball, shape.up, turn, width / height);
    this.gl!.viewport(x, y, width, height);
    this.gl!.scissor(x, y, width, height);
    shader.draw(this.linesOf(shader, shape), matrix, [width, height], lively ? this.colours.lively : this.colours.calm);
  }
}
