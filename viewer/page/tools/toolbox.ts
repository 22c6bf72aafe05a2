// SPDX-License-Identifier: MIT
// The tools' bar, and the one that is in use. All of it is loaded when it is first asked for.
import { Overlay } from '../../src/plugins/overlay.js';
import type { Plugin } from '../../src/index.js';
import { isTyped } from '../../src/typing.js';
import { element, iconButton } from '../parts/element.js';
import { ICONS } from '../parts/icons.js';
import type { PageStage } from '../view/page_stage.js';
import type { StoryHost } from '../view/story_host.js';
import { Cube } from './cube.js';
import { LastingSign } from './lasting_sign.js';
import { ScaleLine } from './scale_line.js';
import type { Tool } from './tool.js';
import { applies, opensByLink, TOOL_NAMES, TOOLS, type ToolName } from './tools.js';
import { words as pageWords } from '../words/words.js';
import { words } from './words/words.js';
import { Workshop, type ToolLinks, type WriteLink } from './workshop.js';
import './tools.css';

/// A plug-in of the view.
export class Toolbox implements Plugin {
  readonly name = 'page tools';
  private readonly shop: Workshop;
  private readonly overlay = new Overlay('tool-overlay');
  private readonly scaleLine: ScaleLine;
  private readonly cube: Cube;
  private readonly lasting: LastingSign;
  private readonly bar: HTMLElement;
  private readonly buttons: Readonly<Record<ToolName, HTMLButtonElement>>;
  private readonly title = element('h2', {});
  private readonly body = element('div', { class: 'tool-body' });
  private readonly card: HTMLElement;
  /// On phones the card is a strip until it is asked for.
  private readonly grow = iconButton(words.more, ICONS.up, () => { this.setGrown(!this.card.classList.contains('grown')); });
  private readonly cross = element('div', { class: 'tool-cross', 'aria-hidden': 'true' });
  private readonly root: HTMLElement;
  private readonly made = new Map<ToolName, Tool>();
  private active: ToolName | null = null;
  /// A link or a story has marks: they are seen without the bar, too.
  private isTold = false;

  /// As the workshop has them.
  constructor(private readonly bench: PageStage, story: StoryHost, links: ToolLinks, write: WriteLink) {
    this.shop = new Workshop(bench, story, links, write);
    this.scaleLine = new ScaleLine(this.shop);
    this.cube = new Cube(bench);
    this.lasting = new LastingSign(bench.surface);
    const entries = TOOL_NAMES.map((name) => [name, this.makeButton(name)] as const);
    this.buttons = Object.fromEntries(entries) as Record<ToolName, HTMLButtonElement>;
    this.bar = element('div', { class: 'bar tool-bar', role: 'toolbar', 'aria-label': words.title, 'aria-orientation': 'vertical' }, ...entries.map(([, button]) => button));
    const close = iconButton(words.close(words.title), ICONS.close, () => void this.put(null));
    this.grow.classList.add('tool-grow');
    this.card = element('section', { class: 'tool-card', hidden: true }, element('div', { class: 'sheet-head' }, this.title, this.grow, close), this.body);
    this.setGrown(false);
    this.root = element('div', { class: 'tools', hidden: true }, this.cross, this.bar, this.card, this.cube.root, this.scaleLine.root);
    bench.root.append(this.overlay.root, this.root, this.lasting.root);
    // Ahead of the view: what a tool takes is taken.
    window.addEventListener('keydown', (event) => { this.keyed(event); }, { signal: bench.signal, capture: true });
    bench.signal.addEventListener('abort', () => { for (const tool of this.made.values()) tool.close?.(); });
  }

  /// Null: the bar alone, or nothing any more if it is there. Resolves once the tool can be used.
  async toggle(name: ToolName | null): Promise<void> {
    if (name === null) this.setOpen(this.root.hidden);
    else if (applies(name, this.shop.places.manifest)) await this.put(name === this.active ? null : name);
  }

  /// Loads tools that a link tells of: what it says is seen. `opens`: the card of the last of them that has one for it.
  async prepare(names: readonly ToolName[], opens: boolean): Promise<void> {
    const fitting = names.filter((name) => applies(name, this.shop.places.manifest));
    await Promise.all(fitting.map(async (name) => this.make(name)));
    if (this.bench.signal.aborted) return;
    this.isTold = true;
    const shown = fitting.filter(opensByLink).at(-1);
    if (opens && shown !== undefined) await this.put(shown);
    this.bench.redraw();
  }

  /// A tool was in use: what it does goes on.
  has(name: ToolName): boolean {
    return this.made.has(name);
  }

  /// A tool is in use.
  get isWorking(): boolean {
    return this.active !== null;
  }

  tapped(right: number, up: number): boolean {
    const tool = this.tool;
    if (tool?.choose === undefined) return false;
    tool.choose(right, up);
    return true;
  }

  drawn(): void {
    for (const tool of this.made.values()) tool.drawn?.();
    this.lasting.show([...this.made.values()].find((tool) => tool !== this.tool && (tool.lasting?.() ?? null) !== null) ?? null);
    if (this.root.hidden && !this.isTold) return;
    const marks = [...this.made.values()].flatMap((tool) => tool.marks?.() ?? []);
    this.overlay.show(marks, this.bench.camera, this.bench.view.surfaceMatrix);
    if (this.root.hidden) return;
    this.scaleLine.show();
    this.cube.show();
  }

  /// Puts away the tool, then the bar. False: nothing is there.
  back(): boolean {
    if (this.root.hidden) return false;
    if (this.active !== null) void this.put(null);
    else this.setOpen(false);
    return true;
  }

  /// Another link is followed.
  follow(links: ToolLinks): void {
    this.isTold = true;
    this.shop.follow(links);
    this.bench.redraw();
  }

  private get tool(): Tool | null {
    return this.active === null ? null : (this.made.get(this.active) ?? null);
  }

  private makeButton(name: ToolName): HTMLButtonElement {
    const { key, icon } = TOOLS[name];
    const button = iconButton(`${words.names[name]} (${key})`, icon, () => void this.toggle(name));
    button.hidden = !applies(name, this.shop.places.manifest);
    button.setAttribute('aria-label', words.names[name]);
    button.setAttribute('aria-keyshortcuts', key);
    button.setAttribute('aria-pressed', 'false');
    return button;
  }

  /// Marks of tools stay until they are opened again.
  private setOpen(open: boolean): void {
    this.root.hidden = !open;
    if (!open) {
      this.isTold = false;
      void this.put(null);
      this.overlay.show([], this.bench.camera, this.bench.view.surfaceMatrix);
    }
    this.bench.redraw();
  }

  private setGrown(grown: boolean): void {
    this.card.classList.toggle('grown', grown);
    this.grow.setAttribute('aria-expanded', String(grown));
    if (!grown) this.card.scrollTop = 0;
  }

  private async put(name: ToolName | null): Promise<void> {
    const inside = this.card.contains(document.activeElement);
    if (inside) (this.active === null ? this.bench.surface : this.buttons[this.active]).focus();
    this.active = name;
    if (name !== null) this.root.hidden = false;
    for (const each of TOOL_NAMES) this.buttons[each].setAttribute('aria-pressed', String(each === name));
    this.root.classList.toggle('working', name !== null);
    this.card.hidden = true;
    this.setGrown(false);
    this.bench.redraw();
    if (name !== null) await this.open(name);
  }

  /// Once.
  private async make(name: ToolName): Promise<void> {
    const { makeTool } = await TOOLS[name].load();
    if (!this.bench.signal.aborted && !this.made.has(name)) this.made.set(name, makeTool(this.shop));
  }

  private async open(name: ToolName): Promise<void> {
    try {
      await this.make(name);
      if (this.active !== name || this.bench.signal.aborted) return;
    } catch {
      const { noCode, noCodeMore } = pageWords.problems;
      const done = this.bench.tell(noCode, {
        more: noCodeMore,
        retry: () => {
          done();
          void this.put(name);
        },
      });
      void this.put(null);
      return;
    }
    this.title.textContent = words.names[name];
    this.card.setAttribute('aria-label', words.names[name]);
    this.body.replaceChildren(this.made.get(name)!.root);
    this.card.hidden = false;
    this.bench.redraw();
  }

  private keyed(event: KeyboardEvent): void {
    const tool = this.tool;
    const { target, key } = event;
    if (tool === null || event.ctrlKey || event.altKey || event.metaKey || isTyped(event)) return;
    if (key === 'Enter' && target instanceof HTMLElement && target.matches('button, a, summary, input')) return;
    if (!this.acts(tool, key)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  /// Enter takes the middle of the picture, Backspace a step back; other keys are the tool's. False: nobody's.
  private acts(tool: Tool, key: string): boolean {
    if (key === 'Enter') return this.tapped(0, 0);
    if (key === 'Backspace') return tool.undo?.() ?? false;
    return tool.key?.(key) ?? false;
  }
}
